// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxel/solid/target_expression.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {

/// Evaluates an expression over a universe one block at a time, both for walks over the whole universe and
/// for walks that visit only a few blocks. All state of a walk is in its EnteredBlock and none in this
/// object, so several threads may call it at once. Thesis 7.2 does this for three operands; here any number
/// is allowed.
class ExpressionBlocks {
 public:
  /// The expression must outlive this object. `margin` as in TargetBlock.
  ExpressionBlocks(const Universe& universe, const TargetExpression& expression,
                   double margin = TargetBlock::centres);

  /// An operand within one block.
  struct Operation {
    Status status = Status::Empty;
    const Node* node = nullptr;  ///< the block's node, for an aligned octree that is Partial here
  };

  /// A block that a walk has entered. An EnteredBlock may be reused for other blocks of the same height.
  struct EnteredBlock {
    int height = 0;        ///< 2 and up
    glm::ivec3 origin{0};  ///< its first voxel
    Cover cover;           ///< of its children; at height 2 ask_words() decides more of them
    // At height 2 only:
    std::array<std::uint64_t, 64> words;  ///< of the wanted leaves that `cover` leaves undecided
    // One entry per operand:
    std::vector<Operation> operations;
    std::vector<Cover> covers;
    std::vector<std::array<std::uint64_t, 64>> operand_words;
  };

  /// Enters the block that contains the whole universe.
  void enter_root(EnteredBlock& root) const;
  /// Enters a child that the outer block's cover leaves undecided. If one octree alone decides there, returns
  /// its node and leaves `inner` without a cover. Precondition: the outer block's height is 3 or more.
  const Node* enter(const EnteredBlock& outer, int child, EnteredBlock& inner) const;
  /// Computes the words of the undecided leaves of `wanted`. A leaf that the first operands already decide
  /// gets no word; `block.cover` holds its status. Precondition: the block's height is 2.
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
