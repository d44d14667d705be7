// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/grey_octree.h"

namespace octotomy::voxel {

/// What a sample looks like.
struct TransferPoint {
  double sample = 0.0;
  glm::vec3 colour{1.0f};  ///< sRGB, 0..1
  double per_mm = 0.0;     ///< extinction: a millimetre of it lets through exp(-per_mm) of the light
};

/// What samples look like in a volume picture: linear between points, in light and extinction; beyond the
/// first and last point as these.
struct TransferFunction {
  std::vector<TransferPoint> points;  ///< two at least, samples ascending
  /// Change of samples over a millimetre from which a place is shaded wholly as a surface; below it is
  /// shaded less, down to none, since noise has no side to be lit.
  double surface_per_mm = 50.0;
};

/// Throws std::invalid_argument naming the point: fewer than two, samples that do not ascend, colours beyond
/// 0..1, extinctions that are negative, numbers that are not finite; or where nothing is visible.
void check(const TransferFunction& transfer);

/// Functions for CT in Hounsfield units: "bone", "skin" (translucent, over bone), "vessels" (of contrast
/// agent). Throws std::invalid_argument naming those there are.
TransferFunction preset_transfer(const std::string& name);
std::vector<std::string> preset_transfers();

/// The lowest sample from which on something is visible: the least sample of positive extinction, or where
/// extinction begins to rise. Precondition: check() passes.
double visible_from(const TransferFunction& transfer);

/// A transfer function by table over the samples there are.
class TransferTable {
 public:
  /// Precondition: check() passes.
  TransferTable(const TransferFunction& transfer, const MinMax& samples);

  struct Entry {
    glm::vec3 light{0.0f};  ///< linear
    float per_mm = 0.0f;
  };
  /// Linear between the integers of the table. Precondition: within the samples' range.
  Entry at(double sample) const;
  /// Whether any sample between two, both included, is visible.
  bool visible(const MinMax& range) const;

 private:
  int first_ = 0;
  std::vector<Entry> entries_;
  std::vector<int> visible_before_;  ///< steps between integers with anything visible, counted up
};

}  // namespace octotomy::voxel
