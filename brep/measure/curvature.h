// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// Curvature of a surface at its vertices. At a vertex on a border, or whose triangles have no area, it is
/// unknown and stored as zeros.
struct Curvature {
  std::vector<double> mean_per_mm;       ///< positive where convex: 1 / r on a ball of radius r
  std::vector<double> gaussian_per_mm2;  ///< 1 / r^2 on a ball, negative on saddles
  std::vector<glm::dvec3> normals;       ///< unit vectors, means of the triangles' normals weighted by angle;
                                         ///< 0 if there are none
  std::vector<double> areas_mm2;         ///< area assigned to each vertex; the sum is the surface's area
  std::vector<std::uint8_t> known;       ///< 1 where the curvature is known
};

/// Mean curvature by the cotangents about each vertex, Gaussian curvature by its angle defect, both over the
/// vertex's mixed Voronoi area. Areas times Gaussian curvature of a closed surface add up to 2 pi times its
/// Euler number, to rounding. On smooth surfaces both converge if triangles stay well shaped. Noise enters
/// with its second derivatives, so apply smooth() to surfaces from scans first. The same bits on any number
/// of threads. Cost: linear. Source: Meyer, Desbrun, Schroeder and Barr, "Discrete differential-geometry
/// operators for triangulated 2-manifolds", 2003.
Curvature curvature(const Mesh& mesh);

}  // namespace octotomy::brep
