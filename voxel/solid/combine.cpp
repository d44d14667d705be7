// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine.h"

#include <array>
#include <bit>
#include <cassert>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/solid/postfix_expression.h"
#include "voxel/solid/target_expression.h"

// One walk over the target's blocks, all operands at once (thesis 7.2 for three operands, here for any
// number). At a block:
//   1 every operand says which of the 64 children are Full, and which are not Empty;
//   2 the expression is run over these covers in three-valued logic, 64 children at a time: most are decided;
//   3 operands that are Full or Empty in an undecided child drop out of the expression there. If one octree
//     alone is left, its node is the answer and is shared;
//   4 otherwise the walk goes into the child, or, at the leaves, runs the expression over words of 64 voxels.
// Children are joined in ascending order, so the result does not depend on threads.

namespace octotomy::voxel {
namespace {

// Blocks of this height and up, 256 voxels a side, are shared out to threads child by child: a child of 64
// voxels a side is some ten to a hundred microseconds of work if a boundary passes it, far above the cost of
// a task.
constexpr int parallel_height = 4;

// An operand within one block.
struct Operation {
  Status status = Status::Empty;
  const Node* node = nullptr;  ///< of an aligned octree that is Partial
};

// What an expression comes down to when some operands are known.
struct Reduced {
  enum class Form : std::uint8_t { Empty, Full, Operand, Complement, Complex };
  Form form = Form::Empty;
  std::uint32_t operand = 0;

  friend Reduced operator~(Reduced a) {
    switch (a.form) {
      case Form::Empty:
        return {Form::Full, 0};
      case Form::Full:
        return {Form::Empty, 0};
      case Form::Operand:
        return {Form::Complement, a.operand};
      case Form::Complement:
        return {Form::Operand, a.operand};
      case Form::Complex:
        break;
    }
    return a;
  }
  friend Reduced operator&(Reduced a, Reduced b) {
    if (a.form == Form::Empty || b.form == Form::Full) return a;
    if (b.form == Form::Empty || a.form == Form::Full) return b;
    if (a.form != Form::Complex && a.form == b.form && a.operand == b.operand) return a;
    return {Form::Complex, 0};
  }
  friend Reduced operator|(Reduced a, Reduced b) { return ~(~a & ~b); }
  friend Reduced operator^(Reduced a, Reduced b) {
    if (a.form == Form::Empty) return b;
    if (b.form == Form::Empty) return a;
    if (a.form == Form::Full) return ~b;
    if (b.form == Form::Full) return ~a;
    return {Form::Complex, 0};
  }
};

class Combiner {
 public:
  Combiner(const Universe& universe, const TargetExpression& expression, const LeafRule* rule)
      : postfix_(expression.postfix()),
        operands_(expression.operands()),
        rule_(rule),
        universe_children_(octotomy::voxel::universe_children(universe.depth)) {}

  Block evaluate_root(int root_height) const {
    std::vector<Operation> operations(operands_.size(), {Status::Partial});
    for (std::size_t i = 0; i < operands_.size(); ++i)
      if (const auto* aligned = std::get_if<AlignedOctreeOperand>(&operands_[i])) {
        const BlockRef root = aligned->octree->root();
        operations[i] = {root.status(), root.node()};
      }
    return evaluate(root_height, glm::ivec3(0), operations.data(), universe_children_);
  }

 private:
  // The block of the result at `origin`; only the children of `allowed` are looked at, the others are Empty.
  Block evaluate(int height, const glm::ivec3& origin, const Operation* operations,
                 std::uint64_t allowed) const {
    assert(height >= 2);
    Scratch scratch(*this, height);
    const TargetBlock block{origin, 1 << (2 * height - 2), rule_ ? rule_->margin : TargetBlock::centres};
    for (std::size_t i = 0; i < operands_.size(); ++i) scratch.covers[i] = cover_of(i, operations[i], block);
    const Cover result = run(scratch) & Cover{allowed, allowed};
    assert((result.full & ~result.some) == 0);
    return height == 2 ? evaluate_leaves(origin, operations, scratch, result)
                       : evaluate_children(height, origin, operations, scratch, result);
  }

  struct Scratch {
    Scratch(const Combiner& combiner, int height)
        : covers(combiner.operands_.size()),
          cover_stack(combiner.postfix_.stack_size),
          reduced_stack(combiner.postfix_.stack_size),
          word_stack(combiner.postfix_.stack_size),
          words(height == 2 ? combiner.operands_.size() : 0) {}
    std::vector<Cover> covers;
    std::vector<Cover> cover_stack;
    std::vector<Reduced> reduced_stack;
    std::vector<std::uint64_t> word_stack;
    std::vector<std::array<std::uint64_t, 64>> words;  ///< of the leaves of a block of height 2
  };

  Cover cover_of(std::size_t i, const Operation& operation, const TargetBlock& block) const {
    if (operation.status == Status::Empty) return {};
    if (operation.status == Status::Full) return {all_children, all_children};
    if (const Node* node = operation.node) return {node->full, node->full | node->partial};
    return cover(operands_[i], block);
  }

  Block evaluate_leaves(const glm::ivec3& origin, const Operation* operations, Scratch& scratch,
                        Cover result) const {
    std::uint64_t undecided = result.undecided();
    std::array<std::uint64_t, 64> words;
    std::size_t count = 0;
    if (rule_ != nullptr) {
      for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1)
        words[count++] = rule_->word(origin + 4 * child_place(std::countr_zero(rest)));
      return make_leaf_block(result.full, undecided, words.data());
    }
    for (std::size_t i = 0; i < operands_.size(); ++i) {
      fetch_words(i, operations[i], origin, undecided, scratch);
      // A node's words are neither empty nor full.
      if (i + 1 == operands_.size() || operations[i].node != nullptr || !settle(i, undecided, scratch))
        continue;
      // What these words decide, the other operands are not asked.
      const Cover settled = run(scratch);
      result.full |= undecided & settled.full;
      undecided &= settled.undecided();
    }
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::size_t>(std::countr_zero(rest));
      words[count++] = postfix_.run<std::uint64_t>([&](std::uint32_t i) { return scratch.words[i][child]; },
                                                   scratch.word_stack.data());
    }
    return make_leaf_block(result.full, undecided, words.data());
  }

  // What the operands' covers make of the expression.
  Cover run(Scratch& scratch) const {
    return postfix_.run<Cover>([&](std::uint32_t i) { return scratch.covers[i]; },
                               scratch.cover_stack.data());
  }

  // Adds to an operand's cover the leaves whose words are empty or full. False if there are none.
  static bool settle(std::size_t i, std::uint64_t wanted, Scratch& scratch) {
    Cover& cover = scratch.covers[i];
    const std::uint64_t open = wanted & cover.undecided();
    std::uint64_t full = 0, empty = 0;
    for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      const std::uint64_t word = scratch.words[i][static_cast<std::size_t>(child)];
      full |= std::uint64_t{word == all_children} << child;
      empty |= std::uint64_t{word == 0} << child;
    }
    cover.full |= full;
    cover.some &= ~empty;
    return (full | empty) != 0;
  }

  // Words of an operand for the wanted leaves of a block.
  void fetch_words(std::size_t i, const Operation& operation, const glm::ivec3& origin, std::uint64_t wanted,
                   Scratch& scratch) const {
    assert((scratch.covers[i].full & ~scratch.covers[i].some) == 0);
    const Cover& cover = scratch.covers[i];
    std::array<std::uint64_t, 64>& words = scratch.words[i];
    const std::uint64_t open = wanted & cover.undecided();
    for (std::uint64_t rest = wanted & ~open; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      words[static_cast<std::size_t>(child)] = (cover.full >> child) & 1 ? all_children : 0;
    }
    if (open == 0) return;
    if (const Node* node = operation.node) {
      for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
        const int child = std::countr_zero(rest);
        words[static_cast<std::size_t>(child)] = node->words()[node->rank(child)];
      }
      return;
    }
    octotomy::voxel::words(operands_[i], {origin, open, words.data()});
  }

  Block evaluate_children(int height, const glm::ivec3& origin, const Operation* operations, Scratch& scratch,
                          Cover result) const {
    std::array<BlockRef, 64> children;
    const std::uint64_t undecided = result.undecided();
    const auto count = static_cast<std::size_t>(std::popcount(undecided));
    std::array<int, 64> numbers;
    std::size_t next = 0;
    for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1)
      numbers[next++] = std::countr_zero(rest);

    const int child_side = 1 << (2 * height - 2);
    // The child, or the node that it shares, which is not retained yet.
    const auto child_block = [&](std::size_t slot, std::vector<Operation>& inner,
                                 std::vector<Reduced>& stack) -> const Node* {
      const int child = numbers[slot];
      const Reduced reduced = reduce(child, operations, scratch.covers, inner, stack);
      if (reduced.form == Reduced::Form::Operand && inner[reduced.operand].node != nullptr)
        return inner[reduced.operand].node;
      const glm::ivec3 place = child_place(child);
      children[slot] = evaluate(height - 1, origin + place * child_side, inner.data(), all_children).detach();
      return nullptr;
    };
    if (height >= parallel_height) {
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t slot) {
        std::vector<Operation> inner(operands_.size());
        std::vector<Reduced> stack(postfix_.stack_size);
        if (const Node* shared = child_block(slot, inner, stack))
          children[slot] = Block::share(BlockRef::of(shared)).detach();
      });
    } else {
      std::vector<Operation> inner(operands_.size());
      std::array<const Node*, 64> shared;
      for (std::size_t slot = 0; slot < count; ++slot) {
        shared[slot] = child_block(slot, inner, scratch.reduced_stack);
        if (shared[slot] != nullptr) prefetch_references(shared[slot]);
      }
      for (std::size_t slot = 0; slot < count; ++slot)
        if (shared[slot] != nullptr) children[slot] = Block::share(BlockRef::of(shared[slot])).detach();
    }
    return make_block(height, result.full, undecided, {children.data(), count});
  }

  // What the expression comes down to in a child, and every operand there.
  Reduced reduce(int child, const Operation* operations, const std::vector<Cover>& covers,
                 std::vector<Operation>& inner, std::vector<Reduced>& stack) const {
    for (std::size_t i = 0; i < inner.size(); ++i) {
      inner[i] = {Status::Partial, nullptr};
      if (((covers[i].some >> child) & 1) == 0)
        inner[i].status = Status::Empty;
      else if ((covers[i].full >> child) & 1)
        inner[i].status = Status::Full;
      else if (const Node* node = operations[i].node)
        inner[i].node = node->nodes()[node->rank(child)];
    }
    return postfix_.run<Reduced>(
        [&](std::uint32_t i) -> Reduced {
          if (inner[i].status == Status::Partial) return {Reduced::Form::Operand, i};
          return {inner[i].status == Status::Full ? Reduced::Form::Full : Reduced::Form::Empty, 0};
        },
        stack.data());
  }

  const PostfixExpression& postfix_;
  const std::vector<Operand>& operands_;
  const LeafRule* rule_;
  std::uint64_t universe_children_;
};

}  // namespace

Octree walk(const Universe& universe, const TargetExpression& expression, const LeafRule* rule) {
  return {universe, Combiner(universe, expression, rule).evaluate_root(root_height(universe.depth))};
}

Octree combine(const Universe& universe, const Expression& expression, const Resampling& resampling) {
  return walk(universe, TargetExpression(postfix_of(expression, universe), universe, resampling));
}

}  // namespace octotomy::voxel
