// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/question/expression_tree.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <string_view>
#include <utility>

namespace octotomy::verify {
namespace {

constexpr std::string_view weakest_first = "|^&-";

int strength(const ExpressionTree& tree) {
  if (tree.parts.size() < 2) return static_cast<int>(weakest_first.size());
  return static_cast<int>(weakest_first.find(tree.symbol));
}

/// The truth table of a Boolean function of six leaves. Bit v is the function's value at a point that is
/// inside exactly those leaves i for which bit i of v is set.
using Table = std::uint64_t;
constexpr std::array<Table, 6> leaf_tables{0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc, 0xf0f0f0f0f0f0f0f0,
                                           0xff00ff00ff00ff00, 0xffff0000ffff0000, 0xffffffff00000000};

Table table_of(const ExpressionTree& tree) {
  if (tree.parts.empty()) return leaf_tables[static_cast<std::size_t>(tree.leaf)];
  Table a = table_of(tree.parts[0]);
  if (tree.symbol == '~') return ~a;
  for (std::size_t i = 1; i < tree.parts.size(); ++i) {
    const Table b = table_of(tree.parts[i]);
    if (tree.symbol == '&') a &= b;
    if (tree.symbol == '|') a |= b;
    if (tree.symbol == '-') a &= ~b;
    if (tree.symbol == '^') a ^= b;
  }
  return a;
}

int largest_leaf(const ExpressionTree& tree) {
  int largest = tree.leaf;
  for (const ExpressionTree& part : tree.parts) largest = std::max(largest, largest_leaf(part));
  return largest;
}

/// The function in which one leaf is fixed to inside or to outside.
Table fixed(Table table, std::size_t leaf, bool inside) {
  assert(leaf < leaf_tables.size());
  const int step = 1 << leaf;
  const Table half = table & (inside ? leaf_tables[leaf] : ~leaf_tables[leaf]);
  return half | (inside ? half >> step : half << step);
}

/// Returns a read-once tree of a function; none if there is no such tree.
std::optional<ExpressionTree> decomposed(Table table);

std::optional<ExpressionTree> joined(Table left, char symbol, Table right) {
  std::optional<ExpressionTree> a = decomposed(left), b = decomposed(right);
  if (!a || !b) return std::nullopt;
  return ExpressionTree{symbol, 0, {std::move(*a), std::move(*b)}};
}

std::optional<ExpressionTree> decomposed(Table table) {
  std::vector<std::size_t> support;
  for (std::size_t leaf = 0; leaf < leaf_tables.size(); ++leaf)
    if (fixed(table, leaf, true) != fixed(table, leaf, false)) support.push_back(leaf);
  if (support.empty()) {
    const ExpressionTree empty{'-', 0, {ExpressionTree{}, ExpressionTree{}}};
    return table == 0 ? empty : ExpressionTree{'~', 0, {empty}};
  }
  if (support.size() == 1) {
    const ExpressionTree leaf{0, static_cast<int>(support[0]), {}};
    return table == leaf_tables[support[0]] ? leaf : ExpressionTree{'~', 0, {leaf}};
  }
  // Tries every way to divide the leaves between two sides; the leaves in `part` belong to the left side.
  // Each side has three functions of its own leaves. `any` is true if some state of the other leaves makes
  // the whole function true, `all` if every state does. `alone` is the whole function with the other leaves
  // outside.
  struct Side {
    Table any, all, alone;
    void forget(std::size_t leaf) {
      any = fixed(any, leaf, true) | fixed(any, leaf, false);
      all = fixed(all, leaf, true) & fixed(all, leaf, false);
      alone = fixed(alone, leaf, false);
    }
  };
  const Table at_nothing = (table & 1) ? ~Table{0} : 0;
  for (unsigned part = 1; part < 1U << (support.size() - 1); ++part) {
    Side left{table, table, table}, right = left;
    for (std::size_t i = 0; i < support.size(); ++i) (((part >> i) & 1) ? right : left).forget(support[i]);
    if (table == (left.any & right.any)) return joined(left.any, '&', right.any);
    if (table == (left.all | right.all)) return joined(left.all, '|', right.all);
    if (table == (left.alone ^ right.alone ^ at_nothing))
      return joined(left.alone, '^', right.alone ^ at_nothing);
  }
  return std::nullopt;
}

}  // namespace

int ExpressionTree::depth() const {
  int deepest = 0;
  for (const ExpressionTree& part : parts) deepest = std::max(deepest, 1 + part.depth());
  return deepest;
}

int ExpressionTree::leaf_count() const {
  int count = parts.empty() ? 1 : 0;
  for (const ExpressionTree& part : parts) count += part.leaf_count();
  return count;
}

std::string text(const ExpressionTree& tree, const std::function<std::string(int leaf)>& name) {
  if (tree.parts.empty()) return name(tree.leaf);
  const auto part = [&](const ExpressionTree& inner, int at_least) {
    const std::string inside = text(inner, name);
    return strength(inner) < at_least ? "(" + inside + ")" : inside;
  };
  const int own = strength(tree);
  if (tree.symbol == '~') return "~" + part(tree.parts[0], own);
  std::string chain = part(tree.parts[0], own);
  for (std::size_t i = 1; i < tree.parts.size(); ++i)
    chain.append({' ', tree.symbol, ' '}).append(part(tree.parts[i], own + 1));
  return chain;
}

std::vector<ExpressionTree> simpler(const ExpressionTree& tree) {
  std::vector<ExpressionTree> all = tree.parts;
  for (std::size_t i = 0; i < tree.parts.size(); ++i)
    for (ExpressionTree& part : simpler(tree.parts[i])) {
      ExpressionTree with = tree;
      with.parts[i] = std::move(part);
      all.push_back(std::move(with));
    }
  return all;
}

std::optional<ExpressionTree> read_once(const ExpressionTree& tree) {
  if (largest_leaf(tree) >= static_cast<int>(leaf_tables.size())) return std::nullopt;
  return decomposed(table_of(tree));
}

}  // namespace octotomy::verify
