// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct RemeshOptions {
  double edge_mm = 2.0;         ///< length that edges get nearly, between 4/5 and 4/3 of it; above 0
  double sharp_angle_deg = 40;  ///< edges whose faces turn by more are kept as lines, 0..180
  int rounds = 5;               ///< of splitting, collapsing, flipping and relaxing, at least 1
};

/// The surface with nearly equilateral triangles of an even size: what a volume mesher and a smoother work
/// best on. Sharp edges and borders are split and thinned but stay where they are, corners too; other
/// vertices slide on the given surface, so that it moves by no more than a new triangle's sagitta, edge_mm^2
/// / (8 r) at a radius of curvature r. Precondition: manifold. The result is manifold, as closed as before
/// and wound alike; walls thinner than an edge may come to intersect: ask health(). Throws
/// std::invalid_argument where an option is out of its range or a triangle has no area, naming it.
/// Deterministic. Cost: some 30 us a triangle of the result and round. Source: Botsch and Kobbelt, "A
/// remeshing approach to multiresolution modeling", SGP 2004, by CGAL.
Mesh remesh(const Mesh& mesh, const RemeshOptions& options);

}  // namespace octotomy::brep
