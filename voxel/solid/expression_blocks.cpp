// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/expression_blocks.h"

#include <bit>
#include <cassert>
#include <memory>

// At a block:
//   1 every operand reports which of the 64 children are Full, and which are not Empty;
//   2 the expression is evaluated on these covers in three-valued logic, 64 children at a time, which decides
//     most children;
//   3 operands that are Full or Empty in an undecided child drop out of the expression there; if a single
//     octree remains, its node is the result;
//   4 otherwise the walk enters the child or, at the leaves, evaluates the expression on words of 64 voxels.

namespace octotomy::voxel {
namespace {

// The form to which an expression reduces when some operands are Full or Empty.
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

// Adds the leaves whose words are empty or full to an operand's cover. Returns false if there are no such
// leaves.
bool settle(Cover& cover, const std::array<std::uint64_t, 64>& words, std::uint64_t wanted) {
  const std::uint64_t open = wanted & cover.undecided();
  std::uint64_t full = 0, empty = 0;
  for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    const std::uint64_t word = words[static_cast<std::size_t>(child)];
    full |= std::uint64_t{word == all_children} << child;
    empty |= std::uint64_t{word == 0} << child;
  }
  cover.full |= full;
  cover.some &= ~empty;
  return (full | empty) != 0;
}

}  // namespace

ExpressionBlocks::ExpressionBlocks(const Universe& universe, const TargetExpression& expression,
                                   double margin)
    : postfix_(expression.postfix()),
      operands_(expression.operands()),
      depth_(universe.depth),
      margin_(margin) {}

// Evaluates the expression on the values that get() returns for its operands.
template <typename Value, typename Get>
Value ExpressionBlocks::run(const Get& get) const {
  std::array<Value, 8> few;
  if (postfix_.stack_size <= few.size()) return postfix_.run<Value>(get, few.data());
  const auto stack = std::make_unique<Value[]>(postfix_.stack_size);
  return postfix_.run<Value>(get, stack.get());
}

Cover ExpressionBlocks::run_covers(const EnteredBlock& block) const {
  return run<Cover>([&](std::uint32_t i) { return block.covers[i]; });
}

void ExpressionBlocks::enter_root(EnteredBlock& root) const {
  root.height = root_height(depth_);
  root.origin = glm::ivec3(0);
  root.operations.assign(operands_.size(), {Status::Partial});
  for (std::size_t i = 0; i < operands_.size(); ++i)
    if (const auto* aligned = std::get_if<AlignedOctreeOperand>(&operands_[i])) {
      const BlockRef block = aligned->octree->root();
      root.operations[i] = {block.status(), block.node()};
    }
  cover_children(root);
  const std::uint64_t inside = universe_children(depth_);
  root.cover = root.cover & Cover{inside, inside};
}

const Node* ExpressionBlocks::enter(const EnteredBlock& outer, int child, EnteredBlock& inner) const {
  assert(outer.height >= 3 && ((outer.cover.undecided() >> child) & 1) != 0);
  inner.operations.resize(operands_.size());
  for (std::size_t i = 0; i < operands_.size(); ++i) {
    Operation& operation = inner.operations[i] = {Status::Partial, nullptr};
    if (((outer.covers[i].some >> child) & 1) == 0)
      operation.status = Status::Empty;
    else if ((outer.covers[i].full >> child) & 1)
      operation.status = Status::Full;
    else if (const Node* node = outer.operations[i].node)
      operation.node = node->nodes()[node->rank(child)];
  }
  const auto reduced = run<Reduced>([&](std::uint32_t i) -> Reduced {
    const Status status = inner.operations[i].status;
    if (status == Status::Partial) return {Reduced::Form::Operand, i};
    return {status == Status::Full ? Reduced::Form::Full : Reduced::Form::Empty, 0};
  });
  if (reduced.form == Reduced::Form::Operand && inner.operations[reduced.operand].node != nullptr)
    return inner.operations[reduced.operand].node;
  inner.height = outer.height - 1;
  inner.origin = outer.origin + child_place(child) * (1 << (2 * inner.height));
  cover_children(inner);
  return nullptr;
}

void ExpressionBlocks::cover_children(EnteredBlock& block) const {
  const TargetBlock target{block.origin, 1 << (2 * block.height - 2), margin_};
  block.covers.resize(operands_.size());
  if (block.height == 2) block.operand_words.resize(operands_.size());
  for (std::size_t i = 0; i < operands_.size(); ++i) {
    const Operation& operation = block.operations[i];
    Cover& cover = block.covers[i] = {};
    if (operation.status == Status::Full)
      cover = {all_children, all_children};
    else if (const Node* node = operation.node)
      cover = {node->full, node->full | node->partial};
    else if (operation.status == Status::Partial)
      cover = octotomy::voxel::cover(operands_[i], target);
    assert((cover.full & ~cover.some) == 0);
  }
  block.cover = run_covers(block);
  assert((block.cover.full & ~block.cover.some) == 0);
}

void ExpressionBlocks::ask_words(EnteredBlock& block, std::uint64_t wanted) const {
  assert(block.height == 2);
  std::uint64_t open = wanted & block.cover.undecided();
  for (std::size_t i = 0; i < operands_.size() && open != 0; ++i) {
    fetch_words(i, open, block);
    // settle() is not needed for words of an aligned octree's Partial node, because its empty and full leaves
    // have no words.
    if (i + 1 == operands_.size() || block.operations[i].node != nullptr ||
        !settle(block.covers[i], block.operand_words[i], open))
      continue;
    // If the words fetched so far determine a leaf, the other operands' words of this leaf are not needed.
    const Cover settled = run_covers(block);
    block.cover.full |= open & settled.full;
    block.cover.some &= settled.some | ~open;
    open &= settled.undecided();
  }
  for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
    const auto child = static_cast<std::size_t>(std::countr_zero(rest));
    block.words[child] = run<std::uint64_t>([&](std::uint32_t i) { return block.operand_words[i][child]; });
  }
}

// Fetches an operand's words for the wanted leaves of a block.
void ExpressionBlocks::fetch_words(std::size_t operand, std::uint64_t wanted, EnteredBlock& block) const {
  const Cover& cover = block.covers[operand];
  std::array<std::uint64_t, 64>& words = block.operand_words[operand];
  const std::uint64_t open = wanted & cover.undecided();
  for (std::uint64_t rest = wanted & ~open; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    words[static_cast<std::size_t>(child)] = (cover.full >> child) & 1 ? all_children : 0;
  }
  if (open == 0) return;
  if (const Node* node = block.operations[operand].node) {
    for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      words[static_cast<std::size_t>(child)] = node->words()[node->rank(child)];
    }
    return;
  }
  octotomy::voxel::words(operands_[operand], {block.origin, open, words.data()});
}

}  // namespace octotomy::voxel
