// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/question/expression_tree.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <set>

#include "tests/verify/truth_value.h"
#include "verify/question/random_expression.h"

namespace octotomy::verify {
namespace {

ExpressionTree leaf(int number) {
  return {0, number, {}};
}
ExpressionTree of(char symbol, const ExpressionTree& a, const ExpressionTree& b) {
  return {symbol, 0, {a, b}};
}
std::string words(const ExpressionTree& tree) {
  return text(tree, [](int i) { return std::string(1, static_cast<char>('a' + i)); });
}

void leaves_of(const ExpressionTree& tree, std::multiset<int>& leaves) {
  if (tree.parts.empty()) leaves.insert(tree.leaf);
  for (const ExpressionTree& part : tree.parts) leaves_of(part, leaves);
}

TEST(SimplerTrees, HaveFewerLeavesOrOperatorsAndEndInLeaves) {
  Random random(3);
  ExpressionTree tree = random_tree(random);
  const std::function<int(const ExpressionTree&)> size = [&](const ExpressionTree& t) {
    int sum = 1;
    for (const ExpressionTree& part : t.parts) sum += size(part);
    return sum;
  };
  while (!tree.parts.empty()) {
    const std::vector<ExpressionTree> all = simpler(tree);
    ASSERT_FALSE(all.empty());
    for (const ExpressionTree& one : all) EXPECT_LT(size(one), size(tree));
    tree = all.back();
  }
  EXPECT_TRUE(simpler(tree).empty());
}

TEST(MentionedOnce, TakesTheSurfaceAwayThatWouldMeetItself) {
  const ExpressionTree a = leaf(0), b = leaf(1), c = leaf(2);
  EXPECT_EQ(words(*read_once(of('&', a, of('^', a, b)))), "a & ~b");
  EXPECT_EQ(words(*read_once(of('-', of('|', a, b), of('&', a, b)))), "a ^ b");
  EXPECT_EQ(words(*read_once(of('-', a, a))), "a - a");
  EXPECT_EQ(words(*read_once({'~', 0, {of('-', b, b)}})), "~(a - a)");
  EXPECT_EQ(words(*read_once(of('|', of('&', a, b), of('&', a, c)))), "a & (b | c)");
}

TEST(MentionedOnce, KnowsThatAMajorityAndAChoiceHaveNoSuchTree) {
  const ExpressionTree a = leaf(0), b = leaf(1), c = leaf(2);
  EXPECT_FALSE(read_once(of('|', of('|', of('&', a, b), of('&', b, c)), of('&', a, c))));
  EXPECT_FALSE(read_once(of('|', of('&', a, b), of('-', c, a))));
  EXPECT_FALSE(read_once(leaf(6)));
}

TEST(MentionedOnce, IsTheSameFunctionWithEveryLeafOnceForRandomTrees) {
  int found = 0, shorter = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const ExpressionTree tree = random_tree(random, {.depth = 6, .leaves = 8, .names = 5, .xors = 2});
    const auto once = read_once(tree);
    if (!once) continue;
    ++found;
    shorter += once->leaf_count() < tree.leaf_count();
    for (unsigned values = 0; values < 32; ++values)
      ASSERT_EQ(tests::truth_value(tree, values), tests::truth_value(*once, values))
          << "seed " << seed << ": " << words(tree);
    std::multiset<int> leaves;
    leaves_of(*once, leaves);
    const bool constant = words(*once) == "a - a" || words(*once) == "~(a - a)";
    if (constant) continue;
    EXPECT_EQ(leaves.size(), std::set<int>(leaves.begin(), leaves.end()).size()) << words(*once);
  }
  EXPECT_GT(found, 500);
  EXPECT_GT(shorter, 300);
}

}  // namespace
}  // namespace octotomy::verify
