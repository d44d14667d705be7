// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine.h"

#include <array>
#include <bit>
#include <cassert>
#include <tbb/parallel_for.h>

#include "voxel/solid/expression_blocks.h"
#include "voxel/solid/postfix_expression.h"
#include "voxel/solid/target_expression.h"

// One walk over the target's blocks handles all operands at once. Children are joined in ascending order, so
// the result does not depend on the number of threads.

namespace octotomy::voxel {
namespace {

using EnteredBlock = ExpressionBlocks::EnteredBlock;

// Blocks of at least this height, 256 voxels a side, are split among threads by their children. A child of 64
// voxels a side that a boundary crosses takes ten to a hundred microseconds, far more than the start of a
// task.
constexpr int parallel_height = 4;

class Combiner {
 public:
  Combiner(const ExpressionBlocks& blocks, const LeafRule* rule) : blocks_(blocks), rule_(rule) {}

  Block evaluate_root() const {
    EnteredBlock root;
    blocks_.enter_root(root);
    return evaluate(root);
  }

 private:
  Block evaluate(EnteredBlock& block) const {
    return block.height == 2 ? evaluate_leaves(block) : evaluate_children(block);
  }

  Block evaluate_leaves(EnteredBlock& block) const {
    if (rule_ == nullptr) blocks_.ask_words(block, all_children);
    const std::uint64_t undecided = block.cover.undecided();
    std::array<std::uint64_t, 64> words;
    std::size_t count = 0;
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      words[count++] = rule_ != nullptr ? rule_->word(block.origin + 4 * child_place(child))
                                        : block.words[static_cast<std::size_t>(child)];
    }
    return make_leaf_block(block.cover.full, undecided, words.data());
  }

  Block evaluate_children(const EnteredBlock& block) const {
    std::array<BlockRef, 64> children;
    const std::uint64_t undecided = block.cover.undecided();
    const auto count = static_cast<std::size_t>(std::popcount(undecided));
    std::array<int, 64> numbers;
    std::size_t next = 0;
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1)
      numbers[next++] = std::countr_zero(rest);

    // Evaluates a child. If the child equals a node of an operand's octree, returns that node, whose
    // reference count is not yet raised. Otherwise stores the result in `children` and returns null.
    const auto child_block = [&](std::size_t slot, EnteredBlock& inner) -> const Node* {
      const Node* shared = blocks_.enter(block, numbers[slot], inner);
      if (shared == nullptr) children[slot] = evaluate(inner).detach();
      return shared;
    };
    if (block.height >= parallel_height) {
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t slot) {
        EnteredBlock inner;
        if (const Node* shared = child_block(slot, inner))
          children[slot] = Block::share(BlockRef::of(shared)).detach();
      });
    } else {
      EnteredBlock inner;
      std::array<const Node*, 64> shared;
      for (std::size_t slot = 0; slot < count; ++slot) {
        shared[slot] = child_block(slot, inner);
        if (shared[slot] != nullptr) prefetch_references(shared[slot]);
      }
      for (std::size_t slot = 0; slot < count; ++slot)
        if (shared[slot] != nullptr) children[slot] = Block::share(BlockRef::of(shared[slot])).detach();
    }
    return make_block(block.height, block.cover.full, undecided, {children.data(), count});
  }

  const ExpressionBlocks& blocks_;
  const LeafRule* rule_;
};

}  // namespace

Octree walk(const Universe& universe, const TargetExpression& expression, const LeafRule* rule) {
  const ExpressionBlocks blocks(universe, expression, rule ? rule->margin : TargetBlock::centres);
  return {universe, Combiner(blocks, rule).evaluate_root()};
}

Octree combine(const Universe& universe, const Expression& expression, const Resampling& resampling) {
  return walk(universe, TargetExpression(postfix_of(expression, universe), universe, resampling));
}

}  // namespace octotomy::voxel
