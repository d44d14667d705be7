// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/bi_tree.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

Octree decoded_bi_tree(int depth, const std::string& nodes) {
  return octree_of(parse_bi_tree(universe_of(depth), nodes));
}

TEST(BiTree, HalvesASlabOnceAndABarTwice) {
  EXPECT_EQ(text(bi_tree(Octree::full(universe_of(3)))), "F");
  EXPECT_EQ(text(bi_tree(tests::box_of(universe_of(3), {0, 0, 0}, {7, 7, 3}))), "zFE");
  EXPECT_EQ(text(bi_tree(tests::box_of(universe_of(3), {4, 0, 0}, {7, 7, 3}))), "xEzFE");
}

TEST(BiTree, ReadBackIsTheSameTreeWithAsFewNodesAsAnOctreeNeedsAtMost) {
  tests::for_each_subject([](const tests::Dense&, const Octree& octree) {
    const BiTree tree = bi_tree(octree);
    ASSERT_TRUE(octree_of(tree) == octree);
    // A Partial octree node is at most seven bisections, which have eight leaves.
    std::uint64_t partial = octree.is_empty() || octree == Octree::full(octree.universe()) ? 0 : 1;
    for (const LevelCount& level : level_counts(octree)) partial += level.partial;
    ASSERT_LE(tree.nodes.size(), 14 * partial + 1);
    ASSERT_EQ(tree.nodes.size() % 2, 1U);
  });
}

/// The least number of nodes, by trying all axes without memory.
std::size_t least_nodes(const tests::Dense& dense, const glm::ivec3& first, const glm::ivec3& edge) {
  int full = 0;
  for (int z = 0; z < edge.z; ++z)
    for (int y = 0; y < edge.y; ++y)
      for (int x = 0; x < edge.x; ++x) full += dense.at(first + glm::ivec3(x, y, z));
  if (full == 0 || full == edge.x * edge.y * edge.z) return 1;
  std::size_t best = SIZE_MAX;
  for (int axis = 0; axis < 3; ++axis) {
    if (edge[axis] == 1) continue;
    glm::ivec3 half = edge, second = first;
    half[axis] /= 2;
    second[axis] += half[axis];
    best = std::min(best, 1 + least_nodes(dense, first, half) + least_nodes(dense, second, half));
  }
  return best;
}

TEST(BiTree, IsTheLeast) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const tests::Dense dense = seed == 0 ? tests::figure_3_1_voxels() : tests::random_dense(4, seed);
    EXPECT_EQ(bi_tree(tests::octree_of(universe_of(2), dense)).nodes.size(),
              least_nodes(dense, glm::ivec3(0), glm::ivec3(4)))
        << "seed " << seed;
  }
}

TEST(BiTree, ThatIsWrongIsRefusedWithTheNode) {
  EXPECT_NE(refusal([] { decoded_bi_tree(2, "xE"); }).find("character 3"), std::string::npos);
  EXPECT_NE(refusal([] { decoded_bi_tree(2, "xEFF"); }).find("character 4"), std::string::npos);
  EXPECT_NE(refusal([] { decoded_bi_tree(2, "xxxEFEF"); }).find("character 3: the node has one voxel"),
            std::string::npos);
  EXPECT_NE(refusal([] { decoded_bi_tree(2, "xEE"); }).find("character 1: its halves"), std::string::npos);
  EXPECT_NE(refusal([] { decoded_bi_tree(2, "P"); }).find("E, F, x, y or z"), std::string::npos);
  EXPECT_THROW(bi_tree(Octree::full(universe_of(8))), std::length_error);
}

TEST(BiTree, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      text(bi_tree(tests::figure_3_1())), "bi-tree", "EFxyz",
      [](const std::string& nodes) { return decoded_bi_tree(2, nodes); },
      [](const Octree& octree) { return text(bi_tree(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
