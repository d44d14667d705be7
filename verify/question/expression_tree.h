// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::verify {

/// A Boolean expression whose leaves are numbered.
struct ExpressionTree {
  char symbol = 0;  ///< & | - ^ with two parts or more, joined from the left; ~ with one part; 0 for a leaf
  int leaf = 0;
  std::vector<ExpressionTree> parts;

  int depth() const;       ///< 0 for a leaf
  int leaf_count() const;  ///< occurrences
};

/// Prints the expression for voxel::parse_expression(), with as few parentheses as possible.
std::string text(const ExpressionTree& tree, const std::function<std::string(int leaf)>& name);

/// Returns all trees with one operator less, in each of which one operator is replaced by one of its parts.
/// Precondition: operators have two parts at most.
std::vector<ExpressionTree> simpler(const ExpressionTree& tree);

/// Returns a read-once tree of the same function, in which each leaf occurs at most once. None if there is no
/// such tree, or if a leaf's number is above five. A constant function becomes a - a or ~(a - a). Cost: the
/// function's 64 values times the number of ways to divide its leaves in two. Source: disjoint decomposition,
/// Ashenhurst, "The decomposition of switching functions", 1957.
std::optional<ExpressionTree> read_once(const ExpressionTree& tree);

}  // namespace octotomy::verify
