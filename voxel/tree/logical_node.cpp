// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/logical_node.h"

#include <bit>
#include <cassert>

#include "voxel/tree/octant_order.h"

namespace octotomy::voxel {

LogicalNode LogicalNode::root(const Octree& octree) {
  const int depth = octree.universe().depth;
  if (depth == 2) return {depth, {}, octree.root().word(0), all_children};
  return {depth, octree.root(), 0, depth % 2 == 0 ? all_children : octant_children};
}

Status LogicalNode::status() const {
  if (side_log2_ <= 2) return status_of(mask_, word_, word_);
  if (const Node* node = block_.node()) return status_of(mask_, node->full, node->full | node->partial);
  return block_.status();
}

LogicalNode LogicalNode::child(int number) const {
  assert(side_log2_ > 0 && number >= 0 && number < 8);
  if (side_log2_ % 2 == 0) return {side_log2_ - 1, block_, word_, octant_mask(number)};
  const int index = std::countr_zero(mask_) + octant_child(number);
  if (side_log2_ == 1) return {0, {}, word_, std::uint64_t{1} << index};
  if (side_log2_ == 3) return {2, {}, block_.word(index), all_children};
  return {side_log2_ - 1, block_.child(index), 0, all_children};
}

}  // namespace octotomy::voxel
