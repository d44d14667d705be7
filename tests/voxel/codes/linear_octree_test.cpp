// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/linear_octree.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

const std::string linear_octree_of_figure = "17, 2, 34, 61, 62, 65";

Octree decoded_linear_octree(int depth, const std::string& codes) {
  return octree_of(parse_linear_octree(universe_of(depth), codes));
}

TEST(LinearOctree, OfFigure31IsTheThesiss) {
  EXPECT_EQ(text(linear_octree(tests::figure_3_1())), linear_octree_of_figure);
  EXPECT_TRUE(decoded_linear_octree(2, linear_octree_of_figure) == tests::figure_3_1());
}

TEST(LinearOctree, ReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense&, const Octree& octree) {
    const LinearOctree linear = linear_octree(octree);
    ASSERT_TRUE(octree_of(linear) == octree);
    ASSERT_EQ(parse_linear_octree(octree.universe(), text(linear)).full, linear.full);
  });
  for (const Octree& octree : tests::sparse_subjects())
    EXPECT_TRUE(decoded_linear_octree(12, text(linear_octree(octree))) == octree);
}

TEST(LinearOctree, HasACodeForEveryFullNodeAndNoOther) {
  const Octree octree = tests::octree_of(universe_of(5), tests::random_dense(32, 5));
  std::size_t full = 0;
  for (const LevelCount& level : level_counts(octree)) full += level.full;
  EXPECT_EQ(linear_octree(octree).full.size(), full);
  EXPECT_EQ(text(linear_octree(Octree::full(universe_of(7)))), "root");
  EXPECT_TRUE(decoded_linear_octree(7, "root") == Octree::full(universe_of(7)));
}

TEST(LinearOctree, FindsAVoxelByBinarySearch) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    if (octree.universe().depth > 4) return;
    const LinearOctree linear = linear_octree(octree);
    dense.for_each([&](const glm::ivec3& v) { ASSERT_EQ(contains(linear, v), dense.at(v) != 0); });
  });
}

TEST(LinearOctree, ThatIsWrongIsRefusedWithTheCodeOrTheCharacter) {
  const auto of = [](const std::string& codes) { return refusal([&] { decoded_linear_octree(2, codes); }); };
  EXPECT_EQ(of("17, 28x"), "linear octree, character 6: expected ',', found '8'");
  EXPECT_EQ(of("17; 2"), "linear octree, character 3: expected ',', found ';'");
  EXPECT_EQ(of("17, "), "linear octree, character 5: expected an octal code, found the end");
  EXPECT_NE(of("123").find("character 1: the code has more digits"), std::string::npos);
  EXPECT_EQ(of("17, 12"), "linear octree, code 2, 12: does not come after 17");
  EXPECT_EQ(of("17, 17"), "linear octree, code 2, 17: does not come after 17");
  EXPECT_EQ(of("1, 17"), "linear octree, code 2, 17: lies inside 1, which is Full");
  EXPECT_NE(of("10, 11, 12, 13, 14, 15, 16, 17").find("code 8, 17: is the last of eight"), std::string::npos);
}

TEST(LinearOctree, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      linear_octree_of_figure, "linear octree", "01234567, ",
      [](const std::string& codes) { return decoded_linear_octree(2, codes); },
      [](const Octree& octree) { return text(linear_octree(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
