// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/shape/prism.h"
#include "voxel/solid/expression.h"

// The footprint of a part that follows a dental arch: a band along a curve in the plane of the arch. settle()
// computes it once as plain geometry, and both kernels use it.
namespace octotomy::planner {

/// The plane of an arch's points, with axes and the points projected onto it.
struct ArchFrame {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, look{0, 0, 1};  ///< unit, LPS; look is the plane's normal
  double height_mm = 0.0;                                 ///< the mean of p . look over the points
  double off_plane_mm = 0.0;                              ///< the largest distance of a point from the plane
  std::vector<glm::dvec2> points_mm;                      ///< coordinates of the points in the plane: (p .
                                                          ///< right, p . up)

  glm::dvec2 project(const glm::dvec3& p_mm) const { return {glm::dot(p_mm, right), glm::dot(p_mm, up)}; }
};

/// The plane of best fit to the points: its normal is the direction in which the points' polygon has the
/// largest area, on the side of `towards`. Throws std::runtime_error if the points lie on one line, within a
/// fiftieth of their length.
ArchFrame arch_frame(const std::vector<glm::dvec3>& points_mm, const glm::dvec3& towards);

/// The outline of all points within half of `width_mm` of a smooth curve through the points, with square
/// ends. The curve is a centripetal Catmull-Rom spline. If a bend's radius is below half the width, the
/// outline's inner side is cut short there. Precondition: at least two different points.
std::vector<glm::dvec2> band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm);
/// An outline as band_outline() makes it, but with half discs at both ends.
std::vector<glm::dvec2> round_band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm);
/// The length in mm of the smooth curve through the points.
double curve_length_mm(const std::vector<glm::dvec2>& points_mm);

/// The points with both ends moved outward by `by_mm`, each along its end segment.
std::vector<glm::dvec2> longer_by(std::vector<glm::dvec2> points_mm, double by_mm);

/// The part of a band between two heights p . look, in a form for each kernel.
struct Slab {
  ArchFrame frame;
  std::vector<glm::dvec2> outline_mm;
  double low_mm = 0.0, high_mm = 0.0;

  /// Throws as brep::solid_of().
  brep::Solid solid() const;
  voxel::Expression expression() const;
  voxel::RegionMask sides() const;
  /// The largest p . direction over the slab's corners.
  double far_end_mm(const glm::dvec3& direction) const;
};

}  // namespace octotomy::planner
