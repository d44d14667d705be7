// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "voxel/expression.h"

namespace octotomy::convert {

/// The surface of an expression, from the voxels of a universe that combine() finds inside: on each edge from
/// a voxel inside to one outside it passes where the expression itself ends, found by bisection to 2^-40 of
/// the edge. So points on the cut of a half-space, box, mask or sphere lie on it, and a flat cut is flat to
/// rounding; a window ends where its samples, interpolated linearly, cross its bound; an octree half way
/// between its voxels. Where two of them meet, the ridge is cut off within one voxel. Closed, manifold,
/// oriented outward; points keep 2^-24 of an edge from samples. In LPS millimetres. Where the expression ends
/// more than once on an edge, it is one of the ends. Closed half a voxel beyond the universe's border.
/// Parallel; same bits on any thread count. Cost: combine(), one pass over side^3 bits, forty questions a
/// point.
brep::Triangles isosurface(const voxel::Universe& universe, const voxel::Expression& expression);

}  // namespace octotomy::convert
