// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxel/solid/target_expression.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {

/// An expression over a universe, one block at a time: for walks that build all of it, and for those that
/// look at a few blocks only. Nothing is kept between questions: what a walk knows of a block is in its
/// EnteredBlock, so threads may ask at once. Thesis 7.2 does so for three operands, this for any number.
class ExpressionBlocks {
 public:
  /// The expression must outlive it. `margin` as TargetBlock's.
  ExpressionBlocks(const Universe& universe, const TargetExpression& expression,
                   double margin = TargetBlock::centres);

  /// An operand within one block.
  struct Operation {
    Status status = Status::Empty;
    const Node* node = nullptr;  ///< of an aligned octree that is Partial
  };

  /// A block that a walk went into. One may be reused for blocks of the same height.
  struct EnteredBlock {
    int height = 0;        ///< 2 and up
    glm::ivec3 origin{0};  ///< its first voxel
    Cover cover;           ///< of its children; at height 2 words narrow it
    // At height 2 only:
    std::array<std::uint64_t, 64> words;  ///< of the leaves asked for that `cover` leaves undecided
    // Of the operands:
    std::vector<Operation> operations;
    std::vector<Cover> covers;
    std::vector<std::array<std::uint64_t, 64>> operand_words;
  };

  /// Goes into the block that holds the whole universe.
  void enter_root(EnteredBlock& root) const;
  /// Goes into a child that the outer block's cover leaves undecided. If one octree alone decides there,
  /// returns its node and enters nothing. Precondition: the outer block's height is 3 or more.
  const Node* enter(const EnteredBlock& outer, int child, EnteredBlock& inner) const;
  /// Asks for the words of the leaves of a mask that are undecided. A leaf that the first operands decide
  /// has no word afterwards: `cover` tells it. Precondition: the block's height is 2.
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
