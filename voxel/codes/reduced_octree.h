// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The rule that makes a Partial node one Full or Empty voxel (thesis 3.3.2, after Srihari).
struct Reduction {
  /// The parts of the node that are counted. Children: its eight children, each first reduced by the same
  /// rule. Voxels: all its voxels.
  enum class Of { Children, Voxels };
  Of of = Of::Children;
  double share = 0.5;  ///< the new voxel is Full if more than this share of the parts is Full; 0..1
};

/// The octree at a lower resolution. Its universe has `levels` fewer levels, and its voxels' edges are
/// 2^levels times as long. Throws std::invalid_argument if fewer than two levels remain or the share is not
/// in 0..1. Cost: one walk through the octree.
Octree reduced(const Octree& octree, int levels, const Reduction& reduction = {});

}  // namespace octotomy::voxel
