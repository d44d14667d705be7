// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::voxel {

/// Rule that selects a solid's voxels (thesis 2.1.2, D1 to D4): voxels wholly inside it, voxels that it
/// touches, voxels whose centre is inside, voxels at least half inside.
enum class Digitisation { Inside, Touching, Centre, Half };

/// The voxels of the universe that the rule selects for a solid. A voxel is a cube that extends half an edge
/// around its centre, understood as a regular set: a solid whose surface only touches a voxel from outside
/// does not touch the voxel. The voxels Inside a solid are therefore exactly those not Touching the solid's
/// complement. Most operands are decided by closed forms (operand_closed_form.cpp), in double precision.
/// Oblique tori, slice masks, resampled octrees and edges where surfaces intersect are refined to 2^-6 of a
/// voxel; voxels still undecided then count as boundary. An octree operand of the same universe consists of
/// its whole voxels. Half compares the shares of digitise_partial(), which have that function's error, with
/// one half. Centre returns the result of combine(). Throws std::invalid_argument if the solid contains a
/// window of samples, except with Centre. Parallel; same bits on any thread count. Cost: grows with the
/// solid's boundary, not with its volume.
Octree digitise(const Universe& universe, const Expression& solid, Digitisation digitisation);

/// The solid, with the filled share of every boundary voxel. A share's error is 1 / 65535 by rounding, and at
/// most 2^-9 on a smooth surface whose curvature is at most 1/3 per voxel. If an edge of the solid runs
/// through the voxel, it is at most 2^-4 of the edge's length in the voxel. Throws as digitise() does.
PartialOctree digitise_partial(const Universe& universe, const Expression& solid);

}  // namespace octotomy::voxel
