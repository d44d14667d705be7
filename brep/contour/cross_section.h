// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/contour.h"
#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// A plane of LPS millimetres with two axes in it: a point is origin + right * u + up * v, and the three
/// directions are orthonormal and right-handed (right x up = normal).
struct Plane {
  glm::dvec3 origin_mm{0.0}, right{1, 0, 0}, up{0, 1, 0}, normal{0, 0, 1};
};

/// The plane through a point, perpendicular to a direction of any non-zero length. `up` is the projection of
/// the patient's z onto the plane, or of -y if the direction is along z. Throws std::invalid_argument if the
/// direction is zero or a number is not finite.
Plane plane_through(const glm::dvec3& point_mm, const glm::dvec3& normal);

struct CrossSection {
  std::vector<Contour> contours;  ///< in the plane's u and v, with the body on their left, so holes run
                                  ///< clockwise
  double area_mm2 = 0.0;          ///< area of the closed contours minus their holes
  double perimeter_mm = 0.0;      ///< of all contours
  std::size_t open = 0;           ///< contours that end at the surface's border
};

/// The contours at which a plane cuts a surface. Points in the plane count as above it, so a face in the
/// plane is treated as if it lay just above. Contours are ordered by their lowest triangle number.
/// Precondition: the surface is oriented. Areas are those enclosed by a closed surface; contours of an open
/// one may stay open. Cost: linear.
CrossSection cross_section(const Mesh& mesh, const Plane& plane);

/// Separates contours that touch themselves or each other at a shared point. A plane through a saddle's
/// vertex makes such contours, and tile_sections() refuses them. Cuts off the corner at 1/1024 of each of its
/// sides, the share by which follow() keeps crossings away from samples. Cost: n log n in the points.
void part_touching(std::vector<Contour>& contours);

}  // namespace octotomy::brep
