// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "voxel/solid/expression_blocks.h"

namespace octotomy::voxel {

/// An expression's blocks from the root down to a height, entered once. Several walks may continue from
/// there, each in its own part.
class TopBlocks {
 public:
  struct TopBlock {
    ExpressionBlocks::EnteredBlock entered;
    /// For each undecided child: the octree node that equals it, or else the entered child. Both null in
    /// blocks of `least_height` or lower.
    std::array<const Node*, 64> nodes{};
    std::array<std::unique_ptr<TopBlock>, 64> children;
  };

  /// The expression must outlive this object, which refers to its leaves. Parallel. Cost: the blocks along
  /// the boundary.
  TopBlocks(const Universe& universe, const Expression& expression, int least_height);
  TopBlocks(const TopBlocks&) = delete;
  TopBlocks& operator=(const TopBlocks&) = delete;

  const ExpressionBlocks& blocks() const { return blocks_; }
  const TopBlock& root() const { return root_; }  ///< lower than `least_height` in a small universe

 private:
  void enter_children(TopBlock& block, int least_height) const;

  TargetExpression target_;
  ExpressionBlocks blocks_;
  TopBlock root_;
};

}  // namespace octotomy::voxel
