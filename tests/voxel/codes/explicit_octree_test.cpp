// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/explicit_octree.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

TEST(ExplicitOctree, OfFigure31HasTheThesissEntries) {
  const ExplicitOctree levels = explicit_octree(tests::figure_3_1());
  ASSERT_EQ(levels.levels.size(), 3U);
  EXPECT_EQ(levels.levels[0], "P");
  EXPECT_EQ(levels.levels[1], "EPFPEEPE");
  EXPECT_EQ(levels.levels[2].size() -
                static_cast<std::size_t>(std::count(levels.levels[2].begin(), levels.levels[2].end(), '.')),
            24U);
  EXPECT_EQ(levels.levels[2][060], 'E');
  EXPECT_EQ(levels.levels[2][061], 'F');
  EXPECT_EQ(levels.levels[2][020], '.');  // below a Full node
  EXPECT_TRUE(octree_of(levels) == tests::figure_3_1());
}

TEST(ExplicitOctree, ReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense&, const Octree& octree) {
    const ExplicitOctree levels = explicit_octree(octree);
    ASSERT_TRUE(octree_of(levels) == octree);
    ASSERT_EQ(parse_explicit_octree(octree.universe(), text(levels)).levels, levels.levels);
  });
}

TEST(ExplicitOctree, IsNotMadeWhereItWouldNotFit) {
  EXPECT_THROW(explicit_octree(Octree::empty(universe_of(10))), std::length_error);
  EXPECT_THROW(parse_explicit_octree(universe_of(12), "0 E"), std::length_error);
}

TEST(ExplicitOctree, ThatIsWrongIsRefusedWithTheEntry) {
  const auto with = [](std::size_t level, std::size_t entry, char status) {
    ExplicitOctree levels = explicit_octree(tests::figure_3_1());
    levels.levels[level][entry] = status;
    return refusal([&] { octree_of(levels); });
  };
  EXPECT_EQ(with(2, 017, 'P'), "explicit octree, level 2, entry 17: a voxel cannot be Partial");
  EXPECT_EQ(with(2, 017, '.'), "explicit octree, level 2, entry 17: a child of a Partial node is missing");
  EXPECT_EQ(with(2, 020, 'E'), "explicit octree, level 2, entry 20: its parent has no children");
  EXPECT_EQ(with(2, 077, 'E'), "explicit octree, level 2, entry 77: its parent has no children");
  EXPECT_EQ(with(1, 1, 'F'), "explicit octree, level 2, entry 10: its parent has no children");
  EXPECT_EQ(with(2, 017, 'E'),
            "explicit octree, level 2, entry 17: it and its seven siblings have the same status, so "
            "their parent cannot be Partial");
  EXPECT_EQ(with(1, 0, 'x'), "explicit octree, level 1, entry 0: use only E, F, P and '.'");
  ExplicitOctree levels = explicit_octree(tests::figure_3_1());
  levels.levels[1] += 'E';
  EXPECT_NE(refusal([&] { octree_of(levels); }).find("level 1: takes 8 entries, here are 9"),
            std::string::npos);
}

TEST(ExplicitOctree, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      text(explicit_octree(tests::figure_3_1())), "explicit octree", "EFP.",
      [](const std::string& levels) { return octree_of(parse_explicit_octree(universe_of(2), levels)); },
      [](const Octree& octree) { return text(explicit_octree(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
