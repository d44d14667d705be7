// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/operand_frame.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Whether a box of voxels of the octree's lattice is Full, Empty or neither; it may leave the universe,
/// beyond which all is Empty. Cost: the nodes along the box's faces, and none below a child that settles it.
Status status_within(const Octree& octree, const VoxelBox& box);

}  // namespace octotomy::voxel
