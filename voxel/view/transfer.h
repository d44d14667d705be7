// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// The appearance of one sample value.
struct TransferPoint {
  /// Samples have 16 bits. Points up to this far apart can be interpolated in single precision.
  static constexpr double max_sample = 1e6;
  /// A nanometre lets through 37 % of the light: opaque at any voxel size.
  static constexpr double max_per_mm = 1e6;

  double sample = 0.0;     ///< -max_sample to max_sample
  glm::vec3 colour{1.0f};  ///< sRGB, 0..1
  double per_mm = 0.0;  ///< extinction, 0 to max_per_mm: a millimetre lets through exp(-per_mm) of the light
};

/// The appearance of samples in a volume picture: linear between points, in light and extinction; constant
/// before the first and after the last point.
struct TransferFunction {
  std::vector<TransferPoint> points;  ///< two at least, samples ascending
  /// A position is shaded fully as a surface if samples change by at least this much per millimetre. A
  /// smaller change is shaded in proportion, because noise has no orientation.
  double surface_per_mm = 50.0;
};

/// Throws std::invalid_argument, which names the point, if there are fewer than two points, samples do not
/// ascend, a number is outside its range or not finite, or no point is visible.
void check(const TransferFunction& transfer);

/// Functions for CT in Hounsfield units: "bone", "skin" (translucent, over bone), "vessels" (with contrast
/// agent). Throws std::invalid_argument that lists the known names.
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
  /// Linear between integers; the nearest end of the table beyond it.
  Entry at(double sample) const;
  /// Whether any sample of the range, ends included, is visible. Precondition: within the table.
  bool visible(const MinMax& range) const;

 private:
  int first_ = 0;
  std::vector<Entry> entries_;
  std::vector<int> visible_before_;  ///< running count of the visible steps between integers
};

}  // namespace octotomy::voxel
