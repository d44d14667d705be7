// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// How a Partial node becomes one voxel (thesis 3.3.2, after Srihari).
struct Reduction {
  /// The parts of the node that are counted. Children: its eight children, each first reduced by the same
  /// rule. Voxels: all its voxels.
  enum class Of { Children, Voxels };
  Of of = Of::Children;
  double share = 0.5;  ///< the new voxel is Full if more than this share of the parts is Full; 0..1
};

/// The octree at a lower resolution: its universe has `levels` levels fewer and voxels 2^levels times as
/// large. Throws std::invalid_argument if fewer than two levels remain or the share is not in 0..1. Cost: one
/// walk.
Octree reduced(const Octree& octree, int levels, const Reduction& reduction = {});

}  // namespace octotomy::voxel
