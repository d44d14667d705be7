// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/treecode.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

const std::string treecode_of_figure = "P(EP(EEEEEEEF)FP(EEEEFEEE)EEP(EFFEEFEE)E)";

TEST(Treecode, OfFigure31IsTheThesiss) {
  EXPECT_EQ(treecode(tests::figure_3_1()), treecode_of_figure);
  EXPECT_TRUE(octree_of_treecode(universe_of(2), treecode_of_figure) == tests::figure_3_1());
}

TEST(Treecode, ReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense&, const Octree& octree) {
    ASSERT_TRUE(octree_of_treecode(octree.universe(), treecode(octree)) == octree);
  });
}

TEST(Treecode, ReachesTheFarCornersOfTheLargestUniverse) {
  for (const Octree& octree : tests::sparse_subjects())
    EXPECT_TRUE(octree_of_treecode(octree.universe(), treecode(octree)) == octree);
}

TEST(Treecode, HasACharacterANodeAndTwoMoreAPartialNode) {
  const Octree octree = tests::octree_of(universe_of(5), tests::random_dense(32, 5));
  std::size_t expected = 3;
  for (const LevelCount& level : level_counts(octree))
    expected += 3 * level.partial + level.full + level.empty;
  EXPECT_EQ(treecode(octree).size(), expected);
}

TEST(Treecode, MayBeSpacedOutOverLines) {
  EXPECT_TRUE(
      octree_of_treecode(universe_of(2), " P (E P(EEEE EEEF)\n F P(EEEEFEEE)\tE E P(EFFEEFEE) E )\n") ==
      tests::figure_3_1());
}

TEST(Treecode, ThatIsWrongIsRefusedWithTheCharacter) {
  const auto of = [](const std::string& text, int depth) {
    return refusal([&] { octree_of_treecode(universe_of(depth), text); });
  };
  EXPECT_EQ(of("", 2), "treecode, character 1: expected a node, E, F or P, found the end");
  EXPECT_EQ(of("P(EQ", 2), "treecode, character 4: expected a node, E, F or P, found 'Q'");
  EXPECT_EQ(of("P[", 2), "treecode, character 2: expected '(', found '['");
  EXPECT_EQ(of("P(EEEEEEEFE)", 2), "treecode, character 11: expected ')', found 'E'");
  EXPECT_EQ(of("EE", 2), "treecode, character 2: expected the end, found 'E'");
  EXPECT_NE(of("P(EEEEEEEE)", 2).find("character 11: the eight children"), std::string::npos);
  EXPECT_NE(of("P(FFFFFFFF)", 2).find("character 11: the eight children"), std::string::npos);
  // One level deeper than the universe.
  const std::string deep = "P(EP(EP(EEEEEEEF)EEEEEE)EEEEEE)";
  EXPECT_NE(of(deep, 2).find("character 7: a node of level 2 is a voxel"), std::string::npos);
  EXPECT_EQ(of(deep, 3), "");
  EXPECT_NE(of(treecode_of_figure, 13).find("depth"), std::string::npos);
}

TEST(Treecode, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      treecode_of_figure, "treecode", "EFP()",
      [](const std::string& text) { return octree_of_treecode(universe_of(2), text); }, treecode);
}

}  // namespace
}  // namespace octotomy::voxel
