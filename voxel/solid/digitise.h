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
/// does not touch the voxel. So Inside of a solid is exactly the complement of Touching of the solid's
/// complement. Most operands are decided by closed forms (operand_closed_form.cpp), in double precision.
/// Oblique tori, slice masks, resampled octrees and edges where surfaces intersect are refined to 2^-6 of a
/// voxel; voxels still undecided then count as boundary. An octree operand of the same universe stands for
/// its whole voxels. Half compares digitise_partial()'s shares, with their error, to one half. Centre is
/// combine(). Throws std::invalid_argument if the solid contains a window of samples, except with Centre.
/// Parallel; same bits on any thread count. Cost: grows with the solid's boundary, not with its volume.
Octree digitise(const Universe& universe, const Expression& solid, Digitisation digitisation);

/// The solid, with the filled share of every boundary voxel. Error of a share: 1 / 65535 by rounding; 2^-9 on
/// a smooth surface whose curvature is at most 1/3 per voxel; if an edge runs through the voxel, 2^-4 of the
/// edge's length in it. Throws as digitise().
PartialOctree digitise_partial(const Universe& universe, const Expression& solid);

}  // namespace octotomy::voxel
