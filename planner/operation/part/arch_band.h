// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/shape/prism.h"
#include "voxel/solid/expression.h"

// The footprint of a part that follows a dental arch: a band around a curve in the arch's plane. Computed
// once by settle() as plain geometry, and used by both kernels.
namespace octotomy::planner {

/// The plane of an arch's points, and the points in it.
struct ArchFrame {
  glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, look{0, 0, 1};  ///< unit, LPS; look is the plane's normal
  double height_mm = 0.0;                                 ///< the mean of p . look over the points
  double off_plane_mm = 0.0;                              ///< the largest distance of a point from the plane
  std::vector<glm::dvec2> points_mm;                      ///< (p . right, p . up)

  glm::dvec2 project(const glm::dvec3& p_mm) const { return {glm::dot(p_mm, right), glm::dot(p_mm, up)}; }
};

/// The plane whose normal is the direction of the largest area of the points' polygon, oriented towards
/// `towards`. Throws std::runtime_error if the points lie on one line, within a fiftieth of their length.
ArchFrame arch_frame(const std::vector<glm::dvec3>& points_mm, const glm::dvec3& towards);

/// The outline of all points within half a width of a smooth curve through the points, square at its ends.
/// The curve is a Catmull-Rom spline with centripetal knots. If the curve bends more sharply than half the
/// width, the outline's inner side is cut short. Precondition: at least two points apart.
std::vector<glm::dvec2> band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm);
/// As band_outline(), with half discs around both ends.
std::vector<glm::dvec2> round_band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm);
/// The length of the smooth curve through the points, mm.
double curve_length_mm(const std::vector<glm::dvec2>& points_mm);

/// The points with both ends moved outward by a length along their end segments.
std::vector<glm::dvec2> longer_by(std::vector<glm::dvec2> points_mm, double by_mm);

/// A slab of the band between two heights p . look, for each kernel.
struct Slab {
  ArchFrame frame;
  std::vector<glm::dvec2> outline_mm;
  double low_mm = 0.0, high_mm = 0.0;

  /// Throws as brep::solid_of().
  brep::Solid solid() const;
  voxel::Expression expression() const;
  voxel::RegionMask sides() const;
  /// The largest p . direction of the slab's corners.
  double far_end_mm(const glm::dvec3& direction) const;
};

}  // namespace octotomy::planner
