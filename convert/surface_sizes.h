// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "convert/mesher_process.h"

namespace octotomy::convert {

/// The side of an equilateral triangle of the surface's mean area.
double mean_side_mm(const MesherInput& surface);

/// What sizes are held to beside the triangles' own.
struct SizeLimits {
  std::optional<double> mean_mm{};  ///< for mean_side_mm(), where the surface was divided in parts
  std::vector<double> most_mm{};    ///< at each point, or none
};

/// How large triangles are about each point of a surface, and how a mesher's may be: lengths in mm at the
/// points, which grow by no more than a share of the way along the triangles' sides.
class SurfaceSizes {
 public:
  /// The side of an equilateral triangle of the mean area of those at a point; no more than that of all, as
  /// flat parts have large triangles up to their sharp edges, and no less than an eighth of it, as what is
  /// far smaller than its surroundings is noise; within the limits; graded. Preconditions: there are
  /// triangles, grading > 0. Cost: n log n, 40 bytes a side.
  SurfaceSizes(const MesherInput& surface, double grading, const SizeLimits& limits = {});

  const std::vector<double>& at_points_mm() const { return sizes_mm_; }
  /// Halves the sizes at points, and grades again.
  void halve(const std::vector<std::uint32_t>& points);
  /// All sizes by a factor.
  void scale(double by);
  /// Some of the points, so that every one has one of them within half its size along the sides.
  std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& points) const;

 private:
  void grade();

  const MesherInput& surface_;
  double grading_;
  std::vector<double> sizes_mm_;
  std::vector<std::size_t> first_;  ///< of each point in `beside_`, and the end
  std::vector<std::uint32_t> beside_;
};

}  // namespace octotomy::convert
