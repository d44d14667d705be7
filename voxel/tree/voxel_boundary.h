// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A face of a voxel of the object whose neighbour across the face is outside the object or the universe.
struct VoxelFace {
  glm::ivec3 voxel{0};
  int axis = 0;  ///< axis of the universe to which the face is perpendicular: 0, 1, 2
  int side = 1;  ///< +1 or -1 along the axis
};

/// The faces around a set of voxels, those of cavities included. They are sorted by leaves of 4^3 voxels, x
/// fastest; within a leaf by axis; for each axis, side -1 comes before +1. Cost: one look-up per block of
/// 16^3 voxels, and seven per leaf that is not empty. Parallel; same order on any thread count.
std::vector<VoxelFace> voxel_boundary(const Octree& octree);

}  // namespace octotomy::voxel
