// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/logical_node.h"
#include "voxel/tree/window_bits.h"

namespace octotomy::voxel {

/// A node of the thesis's min-max octree (3.3.2), seen through a window. Full if all its samples belong to
/// the scan and lie in the window; Empty if the samples' range misses the window or no sample belongs to the
/// scan; otherwise Partial. Refers to its grey octree, which must outlive it.
class GreyNode {
 public:
  /// Constructs an Empty root without an octree.
  GreyNode() = default;
  static GreyNode root(const GreyOctree& grey, Window16 window);

  Status status() const { return status_; }
  int side_log2() const { return scan_.side_log2(); }
  /// Child x + 2y + 4z. Precondition: side_log2() > 0.
  GreyNode child(int number) const;

 private:
  GreyNode(const GreyOctree& grey, Window16 window, const glm::ivec3& origin, const LogicalNode& scan);

  const GreyOctree* grey_ = nullptr;
  Window16 window_;
  glm::ivec3 origin_{0};
  LogicalNode scan_;  ///< this node in the octree of the scan's voxels
  Status status_ = Status::Empty;
};

/// The range of a node's samples, in steps of the octree. Cost: reads up to eight blocks' ranges, or a few
/// samples.
MinMax range_of_node(const GreyOctree& grey, const glm::ivec3& origin, int side_log2);

/// Levels 1..n of the min-max octree, its nodes counted by their status in a window. A node whose samples are
/// all equal has no children. Cost: one pass over the bricks whose samples are not all equal.
std::vector<LevelCount> level_counts(const GreyOctree& grey, Window16 window);

}  // namespace octotomy::voxel
