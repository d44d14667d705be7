// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::verify {

/// A Boolean expression whose leaves are numbered.
struct Tree {
  char symbol = 0;  ///< & | - ^ with two parts, ~ with one, 0: a leaf
  int leaf = 0;
  std::vector<Tree> parts;

  int depth() const;       ///< 0 for a leaf
  int leaf_count() const;  ///< occurrences
};

/// As voxel::parse_expression() reads it, with no more parentheses than it takes.
std::string text(const Tree& tree, const std::function<std::string(int leaf)>& name);

/// All trees with one operator less: an operator replaced by one of its parts.
std::vector<Tree> simpler(const Tree& tree);

/// The same function of its leaves as a tree in which each leaf occurs once at most; none where there is no
/// such tree or there are more than six leaves, numbered up to five. A function that no leaf decides becomes
/// a - a or ~(a - a). Cost: the function's 64 values times the ways to part its leaves in two.
/// Source: disjoint decomposition, Ashenhurst, "The decomposition of switching functions", 1957.
std::optional<Tree> mentioned_once(const Tree& tree);

}  // namespace octotomy::verify
