// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/solid/resampling.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The voxels of the universe whose centre the expression contains, evaluated in one walk over all operands:
/// at every block the expression is reduced by what its operands are there, no operand or intermediate is
/// built, and what a single operand decides is shared with it. An octree operand of the same universe stands
/// for its voxels exactly, and so it does moved by whole voxels; under other motions, or of another universe,
/// it is resampled.
/// Parallel; same bits on any thread count. Cost: grows with the boundary of the result's operands, not with
/// their volume.
Octree combine(const Universe& universe, const Expression& expression, const Resampling& resampling = {});

}  // namespace octotomy::voxel
