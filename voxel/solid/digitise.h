// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::voxel {

/// Which voxels a solid becomes (thesis 2.1.2, D1 to D4): those wholly inside, those any of it touches, those
/// whose centre is inside, those at least half inside.
enum class Digitisation { Inside, Touching, Centre, Half };

/// The voxels of the universe that a solid becomes. A voxel is a cuboid half an edge around its centre, taken
/// as a regular set: a surface that only brushes a voxel from without does not touch it, so Inside of a solid
/// is exactly the complement of Touching of its complement. Decided by closed forms
/// (operand_closed_form.cpp), in double precision. An oblique torus, a mask of slices, a resampled octree and
/// edges where surfaces intersect are refined to 2^-6 of a voxel, and count as boundary if that leaves them
/// open. An octree operand of the same universe stands for its whole voxels. Half is decided by fractions,
/// with their error; Centre is combine(). Throws std::invalid_argument if the solid holds a window of
/// samples, unless by Centre. Parallel; same bits on any thread count. Cost: grows with the solid's boundary,
/// not with its volume.
Octree digitise(const Universe& universe, const Expression& solid, Digitisation digitisation);

/// The solid with the share of every boundary voxel that it fills. Errors of a share: rounding to 1 / 65535;
/// on smooth surface 2^-9 if its curvature is at most 1/3 a voxel; if an edge runs through the voxel, 2^-4 of
/// its length there. Throws as digitise().
PartialOctree digitise_partial(const Universe& universe, const Expression& solid);

}  // namespace octotomy::voxel
