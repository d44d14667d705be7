// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct RemeshOptions {
  double edge_mm = 2.0;         ///< target length of edges, which become between 4/5 and 4/3 of it; above 0
  double sharp_angle_deg = 40;  ///< edges between faces at a larger angle are kept as lines, 0..180
  int rounds = 5;               ///< of splitting, collapsing, flipping and relaxing, at least 1
};

/// The surface with nearly equilateral triangles of uniform size, on which volume meshers and smoothing work
/// best. Sharp edges and borders are split and collapsed but do not move, and neither do corners. Other
/// vertices slide on the given surface, so the surface moves by at most a new triangle's sagitta, edge_mm^2 /
/// (8 r) at a radius of curvature r. Precondition: manifold. The result is manifold, with the same boundary
/// and winding; walls thinner than an edge may intersect afterwards: check with health(). Throws
/// std::invalid_argument, which names the cause, if an option is out of its range or a triangle has no area.
/// Deterministic. Cost: about 30 us per triangle of the result and round. Source: Botsch and Kobbelt, "A
/// remeshing approach to multiresolution modeling", SGP 2004, by CGAL.
Mesh remesh(const Mesh& mesh, const RemeshOptions& options);

}  // namespace octotomy::brep
