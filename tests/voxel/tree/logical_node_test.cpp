// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/logical_node.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"
#include "voxel/tree/octant_order.h"

namespace octotomy::voxel {
namespace {

TEST(OctantOrder, MakesEachOctantAByte) {
  for (int bit = 0; bit < 64; ++bit) {
    const int x = bit & 3;
    const int y = (bit >> 2) & 3;
    const int z = bit >> 4;
    const int octant = (x >> 1) + 2 * (y >> 1) + 4 * (z >> 1);
    const int child = (x & 1) + 2 * (y & 1) + 4 * (z & 1);
    const std::uint64_t mask = std::uint64_t{1} << bit;
    EXPECT_EQ(octant_ordered(mask), std::uint64_t{1} << (8 * octant + child));
    EXPECT_EQ(child_ordered(octant_ordered(mask)), mask);
    EXPECT_EQ(2 * octant_child(octant) + octant_child(child), bit);
    EXPECT_NE(octant_mask(octant) & mask, 0U);
  }
}

void compare(const tests::Dense& dense, const glm::ivec3& origin, const LogicalNode& node) {
  const int side = 1 << node.side_log2();
  int inside = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) inside += dense.at(origin + glm::ivec3(x, y, z));
  const Status expected = inside == 0                    ? Status::Empty
                          : inside == side * side * side ? Status::Full
                                                         : Status::Partial;
  ASSERT_EQ(node.status(), expected) << origin.x << ' ' << origin.y << ' ' << origin.z << " side " << side;
  if (side > 1)
    for (int k = 0; k < 8; ++k)
      compare(dense, origin + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) * (side / 2), node.child(k));
}

TEST(LogicalNode, HasTheStatusOfItsVoxelsAtEveryLevelVirtualChildrenIncluded) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    if (octree.universe().depth <= 5) compare(dense, glm::ivec3(0), LogicalNode::root(octree));
  });
}

}  // namespace
}  // namespace octotomy::voxel
