// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// A face of a voxel inside whose neighbour across it is outside (or beyond the universe).
struct VoxelFace {
  glm::ivec3 voxel{0};
  int axis = 0;  ///< of the universe: 0, 1, 2
  int side = 1;  ///< +1 or -1 along the axis
};

/// The boundary of a set of voxels, in the order of its 4^3 blocks, x fastest. Cost: one look-up per block of
/// the universe and seven per block that is not empty. Parallel; same order on any thread count.
std::vector<VoxelFace> voxel_boundary(const voxel::Octree& octree);

}  // namespace octotomy::verify
