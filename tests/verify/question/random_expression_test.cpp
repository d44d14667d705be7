// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/question/random_expression.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/verify/truth_value.h"
#include "voxel/solid/expression.h"

namespace octotomy::verify {
namespace {

std::string name_of(int leaf) {
  return std::string(1, static_cast<char>('a' + leaf));
}

int count(const ExpressionTree& tree, char symbol) {
  int found = tree.symbol == symbol;
  for (const ExpressionTree& part : tree.parts) found += count(part, symbol);
  return found;
}

bool value(const voxel::Expression::Term& term, unsigned values) {
  using Kind = voxel::Expression::Kind;
  if (term.kind == Kind::Leaf)
    return (values >> static_cast<int>(std::get<voxel::Sphere>(*term.leaf).centre_mm.x)) & 1;
  const bool a = value(*term.left, values);
  if (term.kind == Kind::Not) return !a;
  const bool b = value(*term.right, values);
  return term.kind == Kind::And     ? a && b
         : term.kind == Kind::Or    ? a || b
         : term.kind == Kind::Minus ? a && !b
                                    : a != b;
}

TEST(RandomTree, KeepsItsLimitsReachesThemAndUsesEveryOperator) {
  int deepest = 0, most = 0;
  std::string seen;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const ExpressionTree tree = random_tree(random, {.depth = 6, .leaves = 9, .names = 4, .xors = 2});
    deepest = std::max(deepest, tree.depth());
    most = std::max(most, tree.leaf_count());
    EXPECT_LE(count(tree, '^'), 2) << seed;
    seen += text(tree, name_of);
  }
  EXPECT_EQ(most, 9);
  EXPECT_LE(deepest, 7);  // a complement of a leaf at the end
  EXPECT_GE(deepest, 6);
  for (const char symbol : std::string("&|-^~()")) EXPECT_NE(seen.find(symbol), std::string::npos) << symbol;
}

TEST(RandomTree, AsTextMeansTheSameToTheParser) {
  voxel::Names names;
  names.object = [](std::string_view name) { return voxel::Sphere{{name[0] - 'a', 0, 0}, 1}; };
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const ExpressionTree tree = random_tree(random, {.depth = 6, .leaves = 8, .names = 5, .xors = 3});
    const std::string words = text(tree, name_of);
    const voxel::Expression parsed = voxel::parse_expression(words, names);
    for (unsigned values = 0; values < 32; ++values)
      ASSERT_EQ(tests::truth_value(tree, values), value(parsed.term(), values))
          << "seed " << seed << ": " << words;
  }
}

TEST(RandomTree, IsTheSameOfTheSameSeed) {
  Random one(7), two(7), other(8);
  EXPECT_EQ(text(random_tree(one), name_of), text(random_tree(two), name_of));
  EXPECT_NE(one(), other());
}

TEST(RandomSet, IsOfManyKindsWithinItsSideAndNeverEmpty) {
  voxel::Universe universe;
  universe.depth = 5;
  Random random(1);
  std::string seen;
  for (int i = 0; i < 60; ++i) {
    const RandomSet set = random_set(random, universe, i % 2 ? 16 : 24);
    EXPECT_FALSE(set.octree.is_empty());
    for (int v = 24; v < 32; ++v) EXPECT_FALSE(set.octree.contains({v, 12, 12}));
    seen += set.recipe + " ";
  }
  for (const char* kind : {"ellipsoid", "box", "ring", "rod", "noise", "blobs", "head"})
    EXPECT_NE(seen.find(kind), std::string::npos) << kind;
}

}  // namespace
}  // namespace octotomy::verify
