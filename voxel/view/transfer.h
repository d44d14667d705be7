// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// The appearance of one sample value.
struct TransferPoint {
  /// The largest magnitude of a point's sample. Samples of scans have 16 bits, and points within this limit
  /// can be interpolated in single precision.
  static constexpr double max_sample = 1e6;
  /// The largest extinction: a nanometre transmits 37 % of the light, which is opaque at any voxel size.
  static constexpr double max_per_mm = 1e6;

  double sample = 0.0;     ///< -max_sample to max_sample
  glm::vec3 colour{1.0f};  ///< sRGB, 0..1
  /// Extinction, 0 to max_per_mm: a millimetre transmits the share exp(-per_mm) of the light.
  double per_mm = 0.0;
};

/// The appearance of samples in a volume picture. Between points, light and extinction are interpolated
/// linearly; before the first and after the last point they are constant.
struct TransferFunction {
  std::vector<TransferPoint> points;  ///< at least two points, in ascending order of their samples
  /// A position is shaded fully as a surface if samples change by at least this value per millimetre. At a
  /// smaller change the shading is reduced in proportion, because noise has no orientation.
  double surface_per_mm = 50.0;
};

/// Throws std::invalid_argument, with the point concerned, if there are fewer than two points, samples do not
/// ascend, a number is outside its range or not finite, or no point is visible.
void check(const TransferFunction& transfer);

/// A predefined function for CT in Hounsfield units: "bone", "skin" (translucent, over bone), "vessels" (with
/// contrast agent). Throws std::invalid_argument that lists the known names.
TransferFunction preset_transfer(const std::string& name);
std::vector<std::string> preset_transfers();

/// The sample above which matter becomes visible: the point where extinction begins to rise, or the first
/// point if the first point itself is visible. Precondition: check() passes.
double visible_from(const TransferFunction& transfer);

/// A transfer function tabulated over a range of samples.
class TransferTable {
 public:
  /// Precondition: check() passes.
  TransferTable(const TransferFunction& transfer, const MinMax& samples);

  struct Entry {
    glm::vec3 light{0.0f};  ///< linear
    float per_mm = 0.0f;
  };
  /// The appearance at a sample, interpolated linearly between integers. Beyond the table it is that at the
  /// nearest end.
  Entry at(double sample) const;
  /// Whether any sample of the range, ends included, is visible. Precondition: the range lies within the
  /// table.
  bool visible(const MinMax& range) const;

 private:
  int first_ = 0;
  std::vector<Entry> entries_;
  std::vector<int> visible_before_;  ///< number of visible steps between integers up to each entry
};

}  // namespace octotomy::voxel
