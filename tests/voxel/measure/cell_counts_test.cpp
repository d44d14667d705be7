// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/cell_counts.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "tests/voxel/dense.h"
#include "voxel/filter/components.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

TEST(EulerNumbers, OfBallShellRingAndTwoPartsAreThoseOfTheTextbook) {
  const Universe universe = universe_about_origin(6);
  const auto both = [&](const Expression& solid) {
    const EulerNumbers numbers = euler_numbers(combine(universe, solid));
    EXPECT_EQ(numbers.by_faces, numbers.by_corners);
    return numbers.by_faces;
  };
  EXPECT_EQ(both(Sphere{{0, 0, 0}, 20}), 1);
  EXPECT_EQ(both(Expression(Sphere{{0, 0, 0}, 20}) - Sphere{{1, 0, 0}, 10}), 2);
  EXPECT_EQ(both(Torus{{0, 0, 0}, {0, 0, 1}, 18, 6}), 0);
  EXPECT_EQ(both(Expression(Torus{{0, 0, 0}, {0, 0, 1}, 18, 6}) & HalfSpace{{1, 0, 0}, 0}), 1);
  EXPECT_EQ(both(Expression(Torus{{0, 0, 0}, {0, 0, 1}, 18, 6}) - Box{{-5, -40, -40}, {5, 40, 40}}), 2);
  EXPECT_EQ(euler_numbers(Octree::full(universe)).by_faces, 1);
  EXPECT_EQ(euler_numbers(Octree::full(universe)).by_corners, 1);
  EXPECT_EQ(euler_numbers(Octree::empty(universe)).by_faces, 0);
}

TEST(EulerNumbers, VoxelsThatTouchByAnEdgeAreTwoPartsOrOne) {
  tests::Dense dense(64);
  dense.at({62, 62, 63}) = dense.at({63, 63, 63}) = 1;
  const EulerNumbers edge = euler_numbers(tests::octree_of({6, glm::dmat4(1.0)}, dense));
  EXPECT_EQ(edge.by_faces, 2);
  EXPECT_EQ(edge.by_corners, 1);
}

// Cells of the closed complex counted one by one: corners - edges + faces - voxels.
std::int64_t closed_euler(const tests::Dense& dense, bool invert) {
  const auto in = [&](const glm::ivec3& v) {
    const bool within = glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
                        glm::all(glm::lessThan(v, glm::ivec3(dense.side)));
    return (within && dense.at(v) != 0) != invert;
  };
  std::int64_t sum = 0;
  // Doubled coordinates: odd is the middle of a voxel, even a face between two.
  const int last = 2 * dense.side;
  for (int z = 0; z <= last; ++z)
    for (int y = 0; y <= last; ++y)
      for (int x = 0; x <= last; ++x) {
        const glm::ivec3 cell(x, y, z);
        bool any = false;
        for (int i = 0; i < 8; ++i) {
          const glm::ivec3 way(i & 1, (i >> 1) & 1, i >> 2);
          any = any || in((cell + way * (1 - (cell & 1)) * 2) / 2 - (1 - (cell & 1)));
        }
        const int dimension = (x & 1) + (y & 1) + (z & 1);
        if (any) sum += dimension % 2 == 0 ? 1 : -1;
      }
  return sum;
}

TEST(EulerNumbers, AgreeWithCellsCountedOneByOneOnRandomObjects) {
  int not_one = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const int depth = 2 + static_cast<int>(seed % 3);
    const tests::Dense dense = tests::random_dense(1 << depth, seed + 40);
    const EulerNumbers numbers = euler_numbers(tests::octree_of({depth, glm::dmat4(1.0)}, dense));
    EXPECT_EQ(numbers.by_corners, closed_euler(dense, false)) << "seed " << seed;
    not_one += numbers.by_corners != 1;
  }
  EXPECT_GT(not_one, 10);
}

TEST(CellCounts, AreTheSameOnOneThreadAndTwoAndAcrossWords) {
  const Octree octree = combine(universe_about_origin(7), Sphere{{0, 0, 0}, 63.9});
  const auto two = cell_counts(octree);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(cell_counts(octree), two);
  // A sphere in the middle is its own mirror image: so are its patterns.
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    unsigned mirrored = 0;
    for (unsigned v = 0; v < 8; ++v) mirrored |= (pattern >> v & 1U) << (v ^ 1U);
    EXPECT_EQ(two[pattern], two[mirrored]) << "pattern " << pattern;
  }
}

}  // namespace
}  // namespace octotomy::voxel
