// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// The surface of an expression in LPS millimetres. combine() decides which voxels of the universe are
/// inside. On each edge from a voxel inside to one outside, bisection to 2^-40 of the edge finds where the
/// expression itself ends. So points on the cut of a half-space, box, mask or sphere lie on that cut, and a
/// flat cut is flat to rounding. A window ends where its samples, interpolated linearly, cross its bound; an
/// octree ends half way between its voxels. The ridge where two such ends meet is cut off within one voxel.
/// If the expression ends more than once on an edge, the point is one of the ends.
///
/// Closed, manifold, oriented outward; closed half a voxel beyond the universe's border. Points keep 2^-24 of
/// an edge from samples. Throws as isosurface() of a scene. Parallel; same bits on any thread count. Cost:
/// combine(), one pass over side^3 bits, forty evaluations a point.
brep::Triangles isosurface(const voxel::Universe& universe, const voxel::Expression& expression,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::convert
