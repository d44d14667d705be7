// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

/// Levels 1..n of the condensed grey octree as the thesis counts them (table 3.2): a node whose samples are
/// all alike is Empty where they are the background, otherwise Full; all others are Partial.
/// Cost: one pass over the bricks that are not all alike.
std::vector<LevelCount> level_counts(const GreyOctree& grey);

}  // namespace octotomy::voxel
