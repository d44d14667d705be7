// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A face of a voxel inside whose neighbour across it is outside (or beyond the universe).
struct VoxelFace {
  glm::ivec3 voxel{0};
  int axis = 0;  ///< of the universe: 0, 1, 2
  int side = 1;  ///< +1 or -1 along the axis
};

/// The faces around a set of voxels, those of cavities included, in the order of its leaves of 4^3 voxels, x
/// fastest; in a leaf by axis, -1 before +1. Cost: one look-up per block of 16^3 voxels, seven per leaf of
/// those that are not empty. Parallel; same order on any thread count.
std::vector<VoxelFace> voxel_boundary(const Octree& octree);

}  // namespace octotomy::voxel
