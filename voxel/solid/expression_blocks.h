// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxel/solid/target_expression.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {

/// Evaluates an expression over a universe one block at a time, for walks over the whole universe and for
/// walks that visit only a few blocks. The whole state of a walk is in its EnteredBlock, so several threads
/// may use one object. Thesis 7.2 does this for three operands; here any number is allowed.
class ExpressionBlocks {
 public:
  /// The expression must outlive this object. `margin` has the meaning of TargetBlock::margin.
  ExpressionBlocks(const Universe& universe, const TargetExpression& expression,
                   double margin = TargetBlock::centres);

  /// The state of an operand within one block.
  struct Operation {
    Status status = Status::Empty;
    const Node* node = nullptr;  ///< the block's node, for an aligned octree that is Partial here
  };

  /// A block that a walk has entered. An EnteredBlock may be reused for other blocks of the same height.
  struct EnteredBlock {
    int height = 0;        ///< 2 and up
    glm::ivec3 origin{0};  ///< its first voxel
    Cover cover;           ///< status of its children; at height 2 ask_words() decides more of them
    // At height 2 only:
    std::array<std::uint64_t, 64> words;  ///< words of the wanted leaves that are undecided in `cover`
    // One entry per operand:
    std::vector<Operation> operations;
    std::vector<Cover> covers;
    std::vector<std::array<std::uint64_t, 64>> operand_words;
  };

  /// Enters the block that contains the whole universe.
  void enter_root(EnteredBlock& root) const;
  /// Enters a child that is undecided in the outer block's cover. If a single octree determines the result in
  /// the child, returns that octree's node and does not compute the cover of `inner`; else null.
  /// Precondition: the outer block's height is 3 or more.
  const Node* enter(const EnteredBlock& outer, int child, EnteredBlock& inner) const;
  /// Computes the words of the undecided leaves of `wanted`. A leaf that is already decided by the first
  /// operands gets no word; its status is then in `block.cover`. Precondition: the block's height is 2.
  void ask_words(EnteredBlock& block, std::uint64_t wanted) const;

 private:
  template <typename Value, typename Get>
  Value run(const Get& get) const;
  Cover run_covers(const EnteredBlock& block) const;
  void cover_children(EnteredBlock& block) const;
  void fetch_words(std::size_t operand, std::uint64_t wanted, EnteredBlock& block) const;

  const PostfixExpression& postfix_;
  const std::vector<Operand>& operands_;
  int depth_;  ///< of the universe
  double margin_;
};

}  // namespace octotomy::voxel
