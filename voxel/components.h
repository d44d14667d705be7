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
/// Memory: four bytes per boundary leaf and homogeneous block, not per voxel of the universe.
Components components(const Octree& octree);

}  // namespace octotomy::voxel
