// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// Parts that touch by faces (6-connected, the thesis's 2-adjacency), largest first; equal sizes in the order
/// of their first voxel, x fastest.
struct Components {
  std::vector<std::uint64_t> voxel_counts;
  Octree largest;
};
/// Memory: 20 bytes per run of voxels along x, which follows the boundary, not the volume.
Components components(const Octree& octree);

}  // namespace octotomy::voxel
