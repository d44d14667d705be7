// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/top_blocks.h"

#include <tbb/parallel_for.h>

#include "voxel/solid/postfix_expression.h"

namespace octotomy::voxel {

TopBlocks::TopBlocks(const Universe& universe, const Expression& expression, int least_height)
    : target_(postfix_of(expression, universe), universe), blocks_(universe, target_) {
  blocks_.enter_root(root_.entered);
  enter_children(root_, least_height);
}

void TopBlocks::enter_children(TopBlock& block, int least_height) const {
  if (block.entered.height <= least_height) return;
  tbb::parallel_for(0, 64, [&](int child) {
    if (((block.entered.cover.undecided() >> child) & 1) == 0) return;
    auto inner = std::make_unique<TopBlock>();
    const auto slot = static_cast<std::size_t>(child);
    block.nodes[slot] = blocks_.enter(block.entered, child, inner->entered);
    if (block.nodes[slot] != nullptr) return;
    enter_children(*inner, least_height);
    block.children[slot] = std::move(inner);
  });
}

}  // namespace octotomy::voxel
