// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/contour.h"
#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// A plane of LPS millimetres with axes of its own: a point is origin + right * u + up * v, and the three
/// directions are orthonormal and right-handed (right x up = normal).
struct Plane {
  glm::dvec3 origin_mm{0.0}, right{1, 0, 0}, up{0, 1, 0}, normal{0, 0, 1};
};

/// The plane through a point square to a direction of any length but zero; `up` is the body's z as far as it
/// lies in the plane, or its -y where the direction is along z. Throws std::invalid_argument where there is
/// no direction or something is not finite.
Plane plane_through(const glm::dvec3& point_mm, const glm::dvec3& normal);

struct CrossSection {
  std::vector<Contour> contours;  ///< in the plane's u and v; the body on their left, so holes run clockwise
  double area_mm2 = 0.0;          ///< holes taken off; of the closed contours
  double perimeter_mm = 0.0;      ///< of all contours
  std::size_t open = 0;           ///< contours that end at the surface's border
};

/// Where a plane cuts a surface. Points of the plane count as above it, so a face in the plane is cut as if
/// it lay just above. Contours come by their lowest triangle. Precondition: oriented; what a closed surface
/// encloses is given right, an open one's contours stay open. Cost: linear.
CrossSection cross_section(const Mesh& mesh, const Plane& plane);

}  // namespace octotomy::brep
