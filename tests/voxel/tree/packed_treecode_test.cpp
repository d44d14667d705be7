// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/packed_treecode.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::universe_of;
using Code = std::vector<std::uint8_t>;

TEST(PackedTreecode, OfFigure31IsItsTreecodeInBits) {
  // P(EP(...)FP(...)EEP(...)E): Full child 2, Partial children 1, 3 and 6; then EEEEEEEF, EEEEFEEE, EFFEEFEE.
  EXPECT_EQ(packed_treecode(tests::figure_3_1()), (Code{2, 0x04, 0x4a, 0x80, 0x10, 0x26}));
}

TEST(PackedTreecode, ReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense&, const Octree& octree) {
    ASSERT_TRUE(octree_of_packed_treecode(octree.universe(), packed_treecode(octree)) == octree);
  });
}

TEST(PackedTreecode, ReachesTheFarCornersOfTheLargestUniverse) {
  for (const Octree& octree : tests::sparse_subjects())
    EXPECT_TRUE(octree_of_packed_treecode(octree.universe(), packed_treecode(octree)) == octree);
}

TEST(PackedTreecode, TakesTwoBytesAPartialNodeAndOneWhereItsChildrenAreVoxels) {
  for (int depth = 2; depth <= 5; ++depth) {
    const Octree octree = tests::octree_of(universe_of(depth), tests::random_dense(1 << depth, 7));
    ASSERT_FALSE(octree.is_empty());
    std::size_t expected = 1 + 2;  // the root
    for (const LevelCount& level : level_counts(octree))
      expected += level.partial * (level.level == depth - 1 ? 1 : 2);
    EXPECT_EQ(packed_treecode(octree).size(), expected) << "depth " << depth;
  }
}

TEST(PackedTreecode, MutatedIsRefusedWithTheByteOrAnotherTree) {
  for (int depth = 2; depth <= 5; ++depth) {
    const Code start =
        packed_treecode(tests::octree_of(universe_of(depth), tests::random_dense(1 << depth, 9)));
    int refused = 0;
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
      std::mt19937_64 random(seed);
      const Code code = tests::mutated(start, random, "");
      try {
        ASSERT_EQ(packed_treecode(octree_of_packed_treecode(universe_of(depth), code)), code)
            << "depth " << depth << ", seed " << seed;
      } catch (const std::invalid_argument& error) {
        ++refused;
        ASSERT_EQ(std::string(error.what()).substr(0, 15), "treecode, byte ") << error.what();
      }
    }
    EXPECT_GT(refused, 500) << "depth " << depth;
  }
}

}  // namespace
}  // namespace octotomy::voxel
