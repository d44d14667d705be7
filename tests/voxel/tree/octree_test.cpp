// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/octree.h"

#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "tests/voxel/dense.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::unit_universe;

TEST(Octree, HoldsExactlyTheVoxelsItWasBuiltFromAtEveryDepth) {
  for (int depth = 2; depth <= 6; ++depth)
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      const Dense dense = tests::random_dense(1 << depth, seed);
      const Octree octree = tests::octree_of(unit_universe(depth), dense);
      ASSERT_EQ(tests::dense_of(octree).voxels, dense.voxels);
      std::uint64_t count = 0;
      for (const std::uint8_t voxel : dense.voxels) count += voxel;
      EXPECT_EQ(octree.voxel_count(), count);
    }
}

TEST(Octree, EqualVoxelsAreEqualTreesAndOneVoxelMakesThemDiffer) {
  const Universe universe = unit_universe(5);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dense dense = tests::random_dense(32, seed);
    const Octree octree = tests::octree_of(universe, dense);
    EXPECT_TRUE(octree == tests::octree_of(universe, dense));
    const int at = static_cast<int>(seed * 7 % 32);
    dense.at({at, 31 - at, (at * 5) % 32}) ^= 1;
    EXPECT_FALSE(octree == tests::octree_of(universe, dense));
  }
}

TEST(Octree, AFullUniverseIsOneNodeWhateverTheDepth) {
  for (int depth = 2; depth <= 12; ++depth) {
    const Octree full = Octree::full(unit_universe(depth));
    EXPECT_EQ(full.voxel_count(), std::uint64_t{1} << (3 * depth));
    const int side = 1 << depth;
    EXPECT_TRUE(full.contains({0, 0, 0}));
    EXPECT_TRUE(full.contains({side - 1, side - 1, side - 1}));
    EXPECT_FALSE(full.contains({side, 0, 0}));
    EXPECT_FALSE(full.contains({0, -1, 0}));
  }
}

// The logical octree, counted the plain way.
void count(const Dense& dense, const glm::ivec3& origin, int side, int level,
           std::vector<LevelCount>& levels) {
  std::uint64_t inside = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) inside += dense.at(origin + glm::ivec3(x, y, z));
  const bool full = inside == static_cast<std::uint64_t>(side) * side * side;
  if (level > 0) {
    LevelCount& own = levels[static_cast<std::size_t>(level - 1)];
    ++(full ? own.full : inside == 0 ? own.empty : own.partial);
  }
  if (full || inside == 0) return;
  for (int octant = 0; octant < 8; ++octant)
    count(dense, origin + glm::ivec3(octant & 1, (octant >> 1) & 1, octant >> 2) * (side / 2), side / 2,
          level + 1, levels);
}

TEST(LevelCounts, AreThoseOfThePlainOctreeThoughTwoLevelsShareANode) {
  for (int depth = 2; depth <= 6; ++depth)
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      const Dense dense = tests::random_dense(1 << depth, seed + 100);
      std::vector<LevelCount> expected(static_cast<std::size_t>(depth));
      count(dense, glm::ivec3(0), 1 << depth, 0, expected);
      const std::vector<LevelCount> levels = level_counts(tests::octree_of(unit_universe(depth), dense));
      ASSERT_EQ(levels.size(), expected.size());
      for (std::size_t i = 0; i < levels.size(); ++i) {
        EXPECT_EQ(levels[i].partial, expected[i].partial) << "level " << i + 1;
        EXPECT_EQ(levels[i].full, expected[i].full) << "level " << i + 1;
        EXPECT_EQ(levels[i].empty, expected[i].empty) << "level " << i + 1;
      }
    }
}

TEST(OctreeOfWindow, TakesBothEndsAndKeepsScansThatAreNoMultipleOfABlock) {
  const Universe universe = unit_universe(6);
  Scene scene;
  scene.lattice = {{37, 18, 50}, universe.lps_from_voxel};
  voxel::Int16Samples shorts;
  for (int i = 0; i < 37 * 18 * 50; ++i)
    shorts.push_back(static_cast<std::int16_t>((i * 7919) % 4001 - 2000));
  FloatSamples floats(shorts.begin(), shorts.end());
  std::uint64_t expected = 0;
  for (const std::int16_t value : shorts) expected += value >= -5 && value <= 700;
  scene.samples = shorts;
  const Octree from_shorts = octree_of_window(universe, scene, -5, 700);
  scene.samples = floats;
  EXPECT_EQ(from_shorts.voxel_count(), expected);
  EXPECT_TRUE(octree_of_window(universe, scene, -5, 700) == from_shorts);
  EXPECT_TRUE(octree_of_window(universe, scene, 0.25, 0.75).is_empty());
  scene.lattice.lps_from_voxel[3][0] += 1.0;
  EXPECT_THROW(octree_of_window(universe, scene, -5, 700), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
