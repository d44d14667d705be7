// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct SurfacePath {
  double length_mm = 0.0;
  std::vector<glm::dvec3> points_mm;  ///< points on the surface from start to end, joined by straight lines
};

/// The shortest path along a surface between its points that are nearest to two points in LPS millimetres:
/// exact up to rounding, through triangles and not only along edges. Throws std::invalid_argument if there
/// are no triangles; Error (Geometry) if the points lie on different pieces, or if a point is farther from
/// the surface than the surface is large. Cost: n log n, and mainly the exact search in the triangles that
/// the path might touch, which are those in an ellipsoid around its ends. Source: Xin and Wang, "Improving
/// Chen and Han's algorithm on the discrete geodesic problem", TOG 28(4), 2009, as implemented in CGAL.
SurfacePath shortest_path(const Mesh& mesh, const glm::dvec3& from_mm, const glm::dvec3& to_mm);

}  // namespace octotomy::brep
