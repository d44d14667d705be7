// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/formula.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace octotomy::verify {
namespace {

constexpr std::string_view weakest_first = "|^&-";

int strength(const Tree& tree) {
  if (tree.parts.size() != 2) return static_cast<int>(weakest_first.size());
  return static_cast<int>(weakest_first.find(tree.symbol));
}

/// A function of six leaves as its 64 values: bit v is the value where leaf i is inside if bit i of v is set.
using Table = std::uint64_t;
constexpr std::array<Table, 6> leaf_tables{0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc, 0xf0f0f0f0f0f0f0f0,
                                           0xff00ff00ff00ff00, 0xffff0000ffff0000, 0xffffffff00000000};

Table table_of(const Tree& tree) {
  if (tree.parts.empty()) return leaf_tables[static_cast<std::size_t>(tree.leaf)];
  const Table a = table_of(tree.parts[0]);
  if (tree.symbol == '~') return ~a;
  const Table b = table_of(tree.parts[1]);
  switch (tree.symbol) {
    case '&':
      return a & b;
    case '|':
      return a | b;
    case '-':
      return a & ~b;
    default:
      return a ^ b;
  }
}

int largest_leaf(const Tree& tree) {
  int largest = tree.leaf;
  for (const Tree& part : tree.parts) largest = std::max(largest, largest_leaf(part));
  return largest;
}

/// The function where a leaf is inside, or outside, whatever it is.
Table fixed(Table table, std::size_t leaf, bool inside) {
  const int step = 1 << leaf;
  const Table half = table & (inside ? leaf_tables[leaf] : ~leaf_tables[leaf]);
  return half | (inside ? half >> step : half << step);
}

/// A tree of a function's own; a leaf that is not inside is a complement.
std::optional<Tree> decomposed(Table table);

std::optional<Tree> joined(Table left, char symbol, Table right) {
  std::optional<Tree> a = decomposed(left), b = decomposed(right);
  if (!a || !b) return std::nullopt;
  return Tree{symbol, 0, {std::move(*a), std::move(*b)}};
}

std::optional<Tree> decomposed(Table table) {
  std::vector<std::size_t> support;
  for (std::size_t leaf = 0; leaf < leaf_tables.size(); ++leaf)
    if (fixed(table, leaf, true) != fixed(table, leaf, false)) support.push_back(leaf);
  if (support.empty()) {
    const Tree empty{'-', 0, {Tree{}, Tree{}}};
    return table == 0 ? empty : Tree{'~', 0, {empty}};
  }
  if (support.size() == 1) {
    const Tree leaf{0, static_cast<int>(support[0]), {}};
    return table == leaf_tables[support[0]] ? leaf : Tree{'~', 0, {leaf}};
  }
  // Every way to part the leaves in two: those of `part` are the left's. Of each side, whether any values of
  // the other's leaves make the function true, whether all do, and what it is where they are outside.
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

int Tree::depth() const {
  int deepest = 0;
  for (const Tree& part : parts) deepest = std::max(deepest, 1 + part.depth());
  return deepest;
}

int Tree::leaf_count() const {
  int count = parts.empty() ? 1 : 0;
  for (const Tree& part : parts) count += part.leaf_count();
  return count;
}

std::string text(const Tree& tree, const std::function<std::string(int leaf)>& name) {
  if (tree.parts.empty()) return name(tree.leaf);
  const auto part = [&](const Tree& inner, int at_least) {
    const std::string inside = text(inner, name);
    return strength(inner) < at_least ? "(" + inside + ")" : inside;
  };
  const int own = strength(tree);
  if (tree.symbol == '~') return "~" + part(tree.parts[0], own);
  return part(tree.parts[0], own) + " " + tree.symbol + " " + part(tree.parts[1], own + 1);
}

std::vector<Tree> simpler(const Tree& tree) {
  std::vector<Tree> all = tree.parts;
  for (std::size_t i = 0; i < tree.parts.size(); ++i)
    for (Tree& part : simpler(tree.parts[i])) {
      Tree with = tree;
      with.parts[i] = std::move(part);
      all.push_back(std::move(with));
    }
  return all;
}

std::optional<Tree> mentioned_once(const Tree& tree) {
  if (largest_leaf(tree) >= static_cast<int>(leaf_tables.size())) return std::nullopt;
  return decomposed(table_of(tree));
}

}  // namespace octotomy::verify
