// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <memory>

#include "voxel/solid/expression_blocks.h"

namespace octotomy::voxel {

/// An expression's blocks from the root down to a height, entered once for several walks that go on from
/// there, each in a part of its own.
class TopBlocks {
 public:
  struct TopBlock {
    ExpressionBlocks::EnteredBlock entered;
    /// Of the undecided children of the least height or more: a node that stands for the child, or the child
    /// itself.
    std::array<const Node*, 64> nodes{};
    std::array<std::unique_ptr<TopBlock>, 64> children;
  };

  /// Refers to the expression's leaves: the expression must outlive it. Parallel. Cost: the boundary's
  /// blocks.
  TopBlocks(const Universe& universe, const Expression& expression, int least_height);
  TopBlocks(const TopBlocks&) = delete;
  TopBlocks& operator=(const TopBlocks&) = delete;

  const ExpressionBlocks& blocks() const { return blocks_; }
  const TopBlock& root() const { return root_; }  ///< may be lower than the least height

 private:
  void enter_children(TopBlock& block, int least_height) const;

  TargetExpression target_;
  ExpressionBlocks blocks_;
  TopBlock root_;
};

}  // namespace octotomy::voxel
