// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "voxel/solid/expression_blocks.h"

namespace octotomy::voxel {

/// An expression's blocks from the root down to a height. They are entered once, and several walks may
/// continue from them in different parts of the universe.
class TopBlocks {
 public:
  struct TopBlock {
    ExpressionBlocks::EnteredBlock entered;
    /// For each undecided child either the octree node that equals it or the entered child. In blocks of
    /// `least_height` or lower both are null.
    std::array<const Node*, 64> nodes{};
    std::array<std::unique_ptr<TopBlock>, 64> children;
  };

  /// The expression must outlive this object, which refers to its leaves. Parallel. Cost: grows with the
  /// number of blocks along the boundary.
  TopBlocks(const Universe& universe, const Expression& expression, int least_height);
  TopBlocks(const TopBlocks&) = delete;
  TopBlocks& operator=(const TopBlocks&) = delete;

  const ExpressionBlocks& blocks() const { return blocks_; }
  /// The universe's block; in a small universe it is lower than `least_height`.
  const TopBlock& root() const { return root_; }

 private:
  void enter_children(TopBlock& block, int least_height) const;

  TargetExpression target_;
  ExpressionBlocks blocks_;
  TopBlock root_;
};

}  // namespace octotomy::voxel
