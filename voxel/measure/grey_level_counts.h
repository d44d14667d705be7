// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Levels 1..n of the condensed grey octree as the thesis counts them (table 3.2). A node of equal samples is
/// Empty if they are the background, otherwise Full; other nodes are Partial. Cost: one pass over the bricks
/// whose samples are not all equal.
std::vector<LevelCount> level_counts(const GreyOctree& grey);

}  // namespace octotomy::voxel
