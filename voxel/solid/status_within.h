// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/operand_frame.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The status of a box of voxels of the octree's lattice. The box may extend beyond the universe, where all
/// voxels are Empty. Cost: the nodes along the box's faces; stops as soon as the status is Partial.
Status status_within(const Octree& octree, const VoxelBox& box);

}  // namespace octotomy::voxel
