// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "convert/tet/mesher_process.h"

namespace octotomy::convert {

/// The side of an equilateral triangle of the surface's mean area.
double mean_side_mm(const MesherInput& surface);

/// Limits for sizes, in addition to those that follow from the triangles.
struct SizeLimits {
  std::optional<double> mean_mm{};  ///< replaces mean_side_mm() of a surface with refinements
  std::vector<double> most_mm{};    ///< largest size at each point, or empty
};

/// The size of triangles about each point of a surface, and so of a mesher's elements: lengths in mm that
/// grow along the triangles' sides by at most a given share of the distance.
class SurfaceSizes {
 public:
  /// The side of an equilateral triangle of the mean area of the triangles at a point. At most the mean side
  /// of all, because flat parts have large triangles up to their sharp edges; at least an eighth of it,
  /// because far smaller triangles are noise; within the limits; graded. Preconditions: there are triangles,
  /// grading > 0. Cost: n log n, 40 bytes a side.
  SurfaceSizes(const MesherInput& surface, double grading, const SizeLimits& limits = {});

  const std::vector<double>& at_points_mm() const { return sizes_mm_; }
  /// Halves the sizes at points, then grades again.
  void halve(const std::vector<std::uint32_t>& points);
  /// Multiplies all sizes.
  void scale(double by);
  /// A subset such that each of the points has one of the subset within half its size, measured along the
  /// sides.
  std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& points) const;

 private:
  void grade();

  const MesherInput& surface_;
  double grading_;
  std::vector<double> sizes_mm_;
  std::vector<std::size_t> first_;  ///< index in `beside_` of each point's first entry, then the end
  std::vector<std::uint32_t> beside_;
};

}  // namespace octotomy::convert
