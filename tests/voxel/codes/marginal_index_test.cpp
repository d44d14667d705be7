// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/marginal_index.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

// Figure 3.4.
const std::string margins_of_figure =
    "0 Null Null 1100 1100\n"
    "1 Null 0001 1110 1100\n"
    "2 Null Null 0100 1000\n"
    "3 Null Null 0100 Null\n";

Octree decoded_margins(int depth, const std::string& slices) {
  return octree_of(parse_marginal_index(universe_of(depth), slices));
}

TEST(MarginalIndex, OfFigure31IsTheThesiss) {
  EXPECT_EQ(text(marginal_index(tests::figure_3_1())), margins_of_figure);
  EXPECT_TRUE(decoded_margins(2, margins_of_figure) == tests::figure_3_1());
}

TEST(MarginalIndex, FindsEveryVoxelAndReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    const MarginalIndex index = marginal_index(octree);
    dense.for_each([&](const glm::ivec3& v) { ASSERT_EQ(contains(index, v), dense.at(v) != 0); });
    ASSERT_TRUE(octree_of(index) == octree);
    ASSERT_EQ(parse_marginal_index(octree.universe(), text(index)).slices, index.slices);
  });
}

TEST(MarginalIndex, HasNoRowsForSlicesThatHoldNothing) {
  for (const Octree& octree : tests::sparse_subjects()) {
    const MarginalIndex index = marginal_index(octree);
    EXPECT_TRUE(octree_of(index) == octree);
    EXPECT_TRUE(index.slices[1].empty());
  }
}

TEST(MarginalIndex, ThatIsWrongIsRefusedWithTheRowOrTheCharacter) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string slices = margins_of_figure;
    slices.replace(slices.find(from), from.size(), to);
    return refusal([&] { decoded_margins(2, slices); });
  };
  EXPECT_EQ(with("0001", "0021"), "marginal index, character 32: expected '0', found '2'");
  EXPECT_EQ(with("0001", "0000"), "marginal index, slice 1, row 1: holds no voxel, so it must be Null");
  EXPECT_EQ(with("0100 Null", "Null Null"), "marginal index, slice 3: holds no voxel, so it must be Null");
  EXPECT_NE(with("0001 ", "").find("slice 1 has 3 rows instead of 4 or one Null"), std::string::npos);
  MarginalIndex index = marginal_index(tests::figure_3_1());
  index.slices[1][1][0] |= 16;
  EXPECT_EQ(refusal([&] { octree_of(index); }),
            "marginal index, slice 1, row 1: has bits beyond the universe");
}

TEST(MarginalIndex, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      margins_of_figure, "marginal index", "01 \nNul",
      [](const std::string& slices) { return decoded_margins(2, slices); },
      [](const Octree& octree) { return text(marginal_index(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
