// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/distance_map.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/global_control.h>

#include "tests/voxel/dense.h"
#include "tests/voxel/spaced_universe.h"

namespace octotomy::voxel {
namespace {

using tests::spaced_universe;

// Least squared distance to a voxel in `in`, over the universe and a shell of two voxels around it.
template <typename In>
double nearest_square(const glm::ivec3& from, int side, const glm::dvec3& spacing_mm, const In& in) {
  double least = std::numeric_limits<double>::infinity();
  for (int z = -2; z < side + 2; ++z)
    for (int y = -2; y < side + 2; ++y)
      for (int x = -2; x < side + 2; ++x)
        if (in(glm::ivec3(x, y, z))) {
          const glm::dvec3 d = glm::dvec3(glm::ivec3(x, y, z) - from) * spacing_mm;
          least = std::min(least, glm::dot(d, d));
        }
  return least;
}

TEST(DistanceMap, IsTheLeastOfAllDistancesOnRandomObjectsWhateverTheSpacing) {
  int boundaries = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const int depth = 2 + static_cast<int>(seed % 2);
    const int side = 1 << depth;
    const glm::dvec3 spacing_mm = seed % 3 == 0 ? glm::dvec3(1) : glm::dvec3(0.7, 1.3, 2.1);
    const Universe universe = spaced_universe(depth, spacing_mm);
    const tests::Dense dense = tests::random_dense(side, seed + 77);
    const auto inside = [&](const glm::ivec3& v) {
      return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
             glm::all(glm::lessThan(v, glm::ivec3(side))) && dense.at(v) != 0;
    };
    const Octree octree = tests::octree_of(universe, dense);
    const VoxelRange range{{-1, 0, 1}, {side, side - 2, side}};
    const DistanceMap map = distance_map(octree, range);
    const DistanceMap rest = distance_map_of_complement(octree, range);
    const std::vector<float> signed_mm = signed_distances_mm(octree, range);
    for (int z = range.low.z; z <= range.high.z; ++z)
      for (int y = range.low.y; y <= range.high.y; ++y)
        for (int x = range.low.x; x <= range.high.x; ++x) {
          const glm::ivec3 v(x, y, z);
          const std::size_t i = map.index(v);
          const double expected = nearest_square(v, side, spacing_mm, inside);
          const double expected_rest =
              nearest_square(v, side, spacing_mm, [&](const glm::ivec3& p) { return !inside(p); });
          if (std::isinf(expected))
            EXPECT_TRUE(std::isinf(map.square_mm2[i]));
          else
            EXPECT_NEAR(map.square_mm2[i], expected, 3e-7 * expected) << "seed " << seed;
          EXPECT_NEAR(rest.square_mm2[i], expected_rest, 3e-7 * expected_rest) << "seed " << seed;
          EXPECT_EQ(signed_mm[i] < 0, inside(v)) << "seed " << seed;
          boundaries += inside(v);
        }
  }
  EXPECT_GT(boundaries, 500);
}

TEST(DistanceMap, OfOneVoxelIsTheBallsAroundIt) {
  tests::Dense dense(32);
  dense.at({5, 20, 9}) = 1;
  const Universe universe = spaced_universe(5, glm::dvec3(0.5));
  const DistanceMap map = distance_map(tests::octree_of(universe, dense), {{0, 0, 0}, {31, 31, 31}});
  EXPECT_EQ(map.square_mm2[map.index({8, 24, 9})], 6.25F);
  EXPECT_EQ(map.square_mm2[map.index({5, 20, 9})], 0.0F);
  const Octree ball = octree_where(universe, map, [](double square_mm2) { return square_mm2 <= 6.25; });
  EXPECT_TRUE(ball.contains({8, 24, 9}));
  EXPECT_FALSE(ball.contains({8, 24, 10}));
}

TEST(DistanceMap, IsTheSameOnOneThreadAndTwo) {
  const Octree octree = tests::octree_of(spaced_universe(5, {0.7, 1.3, 2.1}), tests::random_dense(32, 5));
  const VoxelRange range{{0, 0, 0}, {31, 31, 31}};
  const std::vector<float> two = signed_distances_mm(octree, range);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(signed_distances_mm(octree, range), two);
}

TEST(DistanceMap, RefusesAShearedUniverse) {
  Universe universe = spaced_universe(3, glm::dvec3(1));
  universe.lps_from_voxel[1][0] = 0.2;
  EXPECT_THROW(distance_map(Octree::full(universe), {{0, 0, 0}, {7, 7, 7}}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
