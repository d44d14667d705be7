// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct SurfacePath {
  double length_mm = 0.0;
  std::vector<glm::dvec3> points_mm;  ///< from start to end, straight between, on the surface
};

/// The shortest way along a surface between the points of it that are nearest to two points in LPS
/// millimetres: exact for the triangles but for rounding, through triangles and not only along edges. Throws
/// std::invalid_argument where there are no triangles, Error (Geometry) if no way leads from one to the
/// other as they lie on different pieces, or if a point lies farther off than the surface is large. Cost:
/// n log n, and most of all the triangles that the way might touch, which are those of an ellipsoid about its
/// ends. Source: Xin and Wang, "Improving Chen and Han's algorithm on the discrete geodesic problem", TOG
/// 28(4), 2009, as CGAL has it.
SurfacePath shortest_path(const Mesh& mesh, const glm::dvec3& from_mm, const glm::dvec3& to_mm);

}  // namespace octotomy::brep
