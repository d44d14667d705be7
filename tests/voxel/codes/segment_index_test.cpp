// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/segment_index.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

// The table of section 3.2.4.
const std::string segments_of_figure =
    "0 Null Null 0:1 0:1\n"
    "1 Null 3:3 0:2 0:1\n"
    "2 Null Null 1:1 0:0\n"
    "3 Null Null 1:1 Null\n";

Octree decoded_segments(int depth, const std::string& slices) {
  return octree_of(parse_segment_index(universe_of(depth), slices));
}

TEST(SegmentIndex, OfFigure31IsTheThesiss) {
  EXPECT_EQ(text(segment_index(tests::figure_3_1())), segments_of_figure);
  EXPECT_TRUE(decoded_segments(2, segments_of_figure) == tests::figure_3_1());
}

TEST(SegmentIndex, FindsEveryVoxelAndReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    const SegmentIndex index = segment_index(octree);
    dense.for_each([&](const glm::ivec3& v) { ASSERT_EQ(contains(index, v), dense.at(v) != 0); });
    ASSERT_TRUE(octree_of(index) == octree);
    ASSERT_EQ(parse_segment_index(octree.universe(), text(index)).slices, index.slices);
  });
}

TEST(SegmentIndex, HasNoRowsForSlicesThatHoldNothing) {
  for (const Octree& octree : tests::sparse_subjects()) {
    const SegmentIndex index = segment_index(octree);
    EXPECT_TRUE(octree_of(index) == octree);
    EXPECT_TRUE(index.slices[1].empty());
    EXPECT_TRUE(decoded_segments(12, text(index)) == octree);
  }
}

TEST(SegmentIndex, ThatIsWrongIsRefusedWithTheSegmentOrTheCharacter) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string slices = segments_of_figure;
    slices.replace(slices.find(from), from.size(), to);
    return refusal([&] { decoded_segments(2, slices); });
  };
  EXPECT_EQ(with("3:3", "3-3"), "segment index, character 29: expected ':', found '-'");
  EXPECT_EQ(with("3:3", "3:4"), "segment index, character 30: a number of at most 3 was expected");
  EXPECT_EQ(with("3:3", "3:2"), "segment index, slice 1, row 1, segment 3:2: ends before it begins");
  EXPECT_EQ(with("0:2", "0:0,1:2"),
            "segment index, slice 1, row 2, segment 1:2: continues its predecessor: merge the two segments");
  EXPECT_EQ(with("0:2", "2:2,0:0"),
            "segment index, slice 1, row 2, segment 0:0: does not come after its predecessor");
  EXPECT_NE(with("3:3 ", "").find("slice 1 has 3 rows instead of 4 or one Null"), std::string::npos);
  EXPECT_NE(with("3:3", "3:3 Null").find("more rows"), std::string::npos);
  EXPECT_NE(with("1:1 Null", "Null Null").find("slice 3: holds no voxel"), std::string::npos);
  EXPECT_NE(with("2 Null", "4 Null").find("expected '2 '"), std::string::npos);
}

TEST(SegmentIndex, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      segments_of_figure, "segment index", "01234:, \nNul",
      [](const std::string& slices) { return decoded_segments(2, slices); },
      [](const Octree& octree) { return text(segment_index(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
