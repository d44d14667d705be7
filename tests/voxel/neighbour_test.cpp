// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/neighbour.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::universe_of;

TEST(OctalCode, IsThePathToAVoxel) {
  // Equation 3.6: bit k of x, y and z weigh 1, 2 and 4 in the digit of level n - k.
  EXPECT_EQ(to_string(octal_code_of({3, 1, 1}, 2, 2)), "17");
  EXPECT_EQ(to_string(octal_code_of({1, 3, 0}, 2, 1)), "2");
  EXPECT_EQ(to_string(octal_code_of({4095, 0, 2048}, 12, 12)), "511111111111");
  EXPECT_EQ(to_string(OctalCode()), "root");
  for (const glm::ivec3& v : {glm::ivec3(0), glm::ivec3(4095), glm::ivec3(1, 2345, 4000)})
    EXPECT_EQ(origin_voxel(octal_code_of(v, 12, 12), 12), v);
  EXPECT_EQ(origin_voxel(octal_code_of({13, 9, 6}, 4, 2), 4), glm::ivec3(12, 8, 4));
}

TEST(OctalCode, OrdersAsPreorder) {
  const auto code = [](int level, std::uint64_t digits) { return OctalCode(level, digits); };
  EXPECT_LT(code(2, 017), code(1, 02));
  EXPECT_LT(code(1, 01), code(2, 010));
  EXPECT_LT(OctalCode(), code(1, 0));
  EXPECT_GT(code(2, 034), code(1, 03));
  EXPECT_EQ(code(2, 034), code(2, 034));
}

TEST(NodeAt, IsTheNodeOfTheCodeOrTheHomogeneousOneThatHoldsIt) {
  const Octree octree = tests::figure_3_1();
  EXPECT_EQ(node_at(octree, OctalCode(2, 061)).status, Status::Full);
  EXPECT_EQ(node_at(octree, OctalCode(2, 060)).status, Status::Empty);
  EXPECT_EQ(node_at(octree, OctalCode(1, 06)).status, Status::Partial);
  EXPECT_EQ(node_at(octree, OctalCode(2, 023)).code, OctalCode(1, 02));
  EXPECT_EQ(node_at(octree, OctalCode()).status, Status::Partial);
}

TEST(NodeAt, AgreesWithEveryVoxel) {
  tests::for_each_subject([](const Dense& dense, const Octree& octree) {
    const int depth = octree.universe().depth;
    dense.for_each([&](const glm::ivec3& v) {
      const CodedNode node = node_at(octree, octal_code_of(v, depth, depth));
      ASSERT_NE(node.status, Status::Partial);
      ASSERT_EQ(node.status == Status::Full, dense.at(v) != 0);
    });
  });
}

// Every node of the octree in preorder.
void for_each_node(const Octree& octree, const std::function<void(const CodedNode&)>& visit) {
  const std::function<void(const LogicalNode&, const OctalCode&)> walk = [&](const LogicalNode& node,
                                                                             const OctalCode& code) {
    visit({code, node.status()});
    if (node.status() == Status::Partial)
      for (int k = 0; k < 8; ++k) walk(node.child(k), code.child(k));
  };
  walk(LogicalNode::root(octree), OctalCode());
}

TEST(Neighbour, IsWhatPointLocationFindsBesideTheNode) {
  int larger = 0;
  int beyond = 0;
  for (int depth = 2; depth <= 5; ++depth) {
    const Octree octree = tests::octree_of(universe_of(depth), tests::random_dense(1 << depth, 12));
    AncestorArray path(octree);
    for_each_node(octree, [&](const CodedNode& node) {
      path.go_to(node.code);
      ASSERT_EQ(path.current().code, node.code);
      ASSERT_EQ(path.current().status, node.status);
      for (int number = 0; number < direction_count; ++number) {
        const auto direction = static_cast<Direction>(number);
        const int side = 1 << (depth - node.code.level());
        const glm::ivec3 beside = origin_voxel(node.code, depth) + step(direction) * side;
        const auto found = path.neighbour(direction);
        const bool outside = glm::any(glm::lessThan(beside, glm::ivec3(0))) ||
                             glm::any(glm::greaterThanEqual(beside, glm::ivec3(1 << depth)));
        ASSERT_EQ(found.has_value(), !outside);
        beyond += outside;
        if (outside) continue;
        const CodedNode expected = node_at(octree, octal_code_of(beside, depth, node.code.level()));
        ASSERT_EQ(found->code, expected.code);
        ASSERT_EQ(found->status, expected.status);
        larger += found->code.level() < node.code.level();
      }
    });
  }
  EXPECT_GT(larger, 100);
  EXPECT_GT(beyond, 100);
}

struct Mean {
  double from_pivot = 0.0;
  double down_and_up = 0.0;
};

// Mean accesses over the nodes of one level, those on the border counting none.
Mean mean_accesses(const Octree& octree, int level, Direction direction) {
  AncestorArray path(octree);
  std::uint64_t nodes = 0;
  std::uint64_t from_pivot = 0;
  std::uint64_t down_and_up = 0;
  for_each_node(octree, [&](const CodedNode& node) {
    if (node.code.level() != level) return;
    path.go_to(node.code);
    const std::uint64_t before = path.access_count();
    const auto found = path.neighbour(direction);
    ++nodes;
    from_pivot += path.access_count() - before;
    if (found) down_and_up += static_cast<std::uint64_t>(accesses_down_and_up(node.code, found->code));
  });
  return {static_cast<double>(from_pivot) / static_cast<double>(nodes),
          static_cast<double>(down_and_up) / static_cast<double>(nodes)};
}

// Every node above the voxels is Partial: the statuses of voxels are random, but no eight are alike.
Octree noise(int depth) {
  std::mt19937_64 random(static_cast<std::uint64_t>(depth));
  Dense dense(1 << depth);
  for (std::uint8_t& voxel : dense.voxels) voxel = random() & 1;
  for (int z = 0; z < dense.side; z += 2)
    for (int y = 0; y < dense.side; y += 2)
      for (int x = 0; x < dense.side; x += 2) {
        dense.at({x, y, z}) = 0;
        dense.at({x + 1, y, z}) = 1;
      }
  return tests::octree_of(universe_of(depth), dense);
}

TEST(Neighbour, TakesNearlyTwoAccessesFromThePivotAndFourDownAndUp) {
  // Theorem 3.1. Of the M nodes of level m, M / 2^i take i accesses and M / 2^m have no neighbour:
  // the mean is the sum of i / 2^i up to m, 2 - (m + 2) / 2^m.
  double before = 0.0;
  for (int depth = 2; depth <= 7; ++depth) {
    const Octree octree = noise(depth);
    for (int number = 0; number < direction_count; ++number) {
      const Mean mean = mean_accesses(octree, depth, static_cast<Direction>(number));
      const double expected = 2.0 - (depth + 2) * std::pow(0.5, depth);
      EXPECT_DOUBLE_EQ(mean.from_pivot, expected) << "depth " << depth << ", direction " << number;
      EXPECT_DOUBLE_EQ(mean.down_and_up, 2.0 * expected);
      if (number > 0) continue;
      EXPECT_GT(mean.from_pivot, before);
      EXPECT_LT(mean.from_pivot, 2.0);
      before = mean.from_pivot;
    }
  }
  EXPECT_GT(before, 1.9);
}

TEST(Neighbour, TakesLessWhereNodesAreHomogeneous) {
  for (std::uint64_t seed = 20; seed < 30; ++seed) {
    const Octree octree = tests::octree_of(universe_of(6), tests::random_dense(64, seed));
    bool deep = false;
    for (const LevelCount& level : level_counts(octree))
      deep = deep || (level.level == 6 && level.full > 100);
    if (!deep) continue;
    const Mean mean = mean_accesses(octree, 6, Direction::PlusY);
    EXPECT_LT(mean.from_pivot, 2.0) << "seed " << seed;
    EXPECT_LT(mean.down_and_up, 4.0);
    EXPECT_GE(mean.down_and_up, 2.0 * mean.from_pivot);
  }
}

TEST(Neighbour, CodesCarryAcrossTheLargestUniverse) {
  const OctalCode below_middle = octal_code_of({2047, 5, 9}, 12, 12);
  EXPECT_EQ(neighbour_code(below_middle, Direction::PlusX), octal_code_of({2048, 5, 9}, 12, 12));
  EXPECT_EQ(neighbour_code(octal_code_of({2048, 5, 9}, 12, 12), Direction::MinusX), below_middle);
  EXPECT_FALSE(neighbour_code(octal_code_of({4095, 0, 0}, 12, 12), Direction::PlusX).has_value());
  EXPECT_FALSE(neighbour_code(OctalCode(), Direction::MinusZ).has_value());
  // Across the middle plane the pivot is the root, and the walk is twelve nodes long.
  const Octree pair = tests::box_of(universe_of(12), {2047, 5, 9}, {2048, 5, 9});
  AncestorArray path(pair);
  path.go_to(below_middle);
  EXPECT_EQ(path.access_count(), 12U);
  EXPECT_EQ(path.neighbour(Direction::PlusX)->status, Status::Full);
  EXPECT_EQ(path.access_count(), 24U);
}

}  // namespace
}  // namespace octotomy::voxel
