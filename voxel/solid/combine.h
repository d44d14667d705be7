// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/solid/resampling.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The voxels of the universe whose centre is in the expression, computed in one walk over all operands. At
/// every block, operands that are Full or Empty drop out of the expression. No operand or intermediate result
/// is built as an octree. Where only one octree operand determines the result, the result shares its nodes.
/// An octree operand of the same universe, at rest or moved by whole voxels, contributes exactly its voxels.
/// An octree under another motion or of another universe is resampled. Parallel; same bits on any thread
/// count. Cost: grows with the boundary of the operands, not with their volume.
Octree combine(const Universe& universe, const Expression& expression, const Resampling& resampling = {});

}  // namespace octotomy::voxel
