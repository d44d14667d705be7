// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A node of the thesis's octree (3.3): eight children, level 0 the root, level n single voxels. It is a
/// value of a few words that refers to its octree, which must outlive it.
class LogicalNode {
 public:
  /// Constructs an Empty root without an octree.
  LogicalNode() = default;
  static LogicalNode root(const Octree& octree);

  Status status() const;
  /// The node is a cube of 2^side_log2 voxels a side; side_log2 is n minus its level.
  int side_log2() const { return side_log2_; }
  /// Child x + 2y + 4z. A homogeneous node returns a virtual child with its own status. Precondition:
  /// side_log2() > 0.
  LogicalNode child(int number) const;

 private:
  LogicalNode(int side_log2, BlockRef block, std::uint64_t word, std::uint64_t mask)
      : block_(block), word_(word), mask_(mask), side_log2_(side_log2) {}

  // A node of at least 8 voxels a side is a block or, if side_log2 is odd, the children `mask_` of a block. A
  // smaller node is the bits `mask_` of a leaf's word.
  BlockRef block_;
  std::uint64_t word_ = 0;
  std::uint64_t mask_ = all_children;
  int side_log2_ = 0;
};

}  // namespace octotomy::voxel
