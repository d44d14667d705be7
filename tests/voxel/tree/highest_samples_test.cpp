// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/highest_samples.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "voxel/space/scene.h"

namespace octotomy::voxel {
namespace {

GreyOctree with_bright_voxel(int height, const glm::ivec3& bright) {
  const int side = 1 << height;
  const Universe universe{
      height, axis_aligned_lattice(glm::ivec3(side), glm::dvec3(1.0), glm::dvec3(0.0)).lps_from_voxel};
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(scene.lattice.sample_count(), 10);
  samples[static_cast<std::size_t>(bright.x + side * (bright.y + side * bright.z))] = 2000;
  scene.samples = std::move(samples);
  return grey_octree_of(universe, scene);
}

/// Whether a voxel lies among those that the cells of an aligned cube reach.
bool reaches(const glm::ivec3& cell, int edge, const glm::ivec3& voxel) {
  const glm::ivec3 low = cell & -edge;
  return glm::all(glm::greaterThanEqual(voxel, low)) && glm::all(glm::lessThanEqual(voxel, low + edge));
}

TEST(HighestSamples, SkipNoCubeThatReachesTheBrightVoxelAndSkipLargeCubesAwayFromIt) {
  const glm::ivec3 bright(40, 17, 3);
  const HighestSamples highest(with_bright_voxel(6, bright));
  int none = 0, of_leaf = 0, of_block = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const glm::ivec3 cell(x, y, z);
        const int edge = highest.edge_without(cell, 1000.0);
        none += edge == 0;
        of_leaf += edge == 4;
        of_block += edge == 16;
        ASSERT_EQ(highest.of_leaf(cell) == 2000, edge == 0) << x << " " << y << " " << z;
        ASSERT_FALSE(edge > 0 && reaches(cell, edge, bright)) << x << " " << y << " " << z;
        if (reaches(cell, 4, bright)) {
          ASSERT_EQ(edge, 0) << x << " " << y << " " << z;
        }
      }
  // The bright voxel's leaf and those before it along each axis, none before it along z; in four blocks.
  EXPECT_EQ(none, 4 * 64);
  EXPECT_EQ(of_leaf, 2 * 4096 - 4 * 64);
  EXPECT_EQ(of_block, 64 * 64 * 64 - 2 * 4096);
  EXPECT_EQ(highest.edge_without({0, 0, 0}, 2000.0), 64);
}

TEST(HighestSamples, OfACellBeforeTheNextLeafCountItsFirstVoxels) {
  const HighestSamples highest(with_bright_voxel(4, {8, 5, 5}));
  EXPECT_EQ(highest.of_leaf({7, 5, 5}), 2000);
  EXPECT_EQ(highest.of_leaf({3, 5, 5}), 10);
  EXPECT_EQ(highest.of_leaf({8, 5, 5}), 2000);
  EXPECT_EQ(highest.of_leaf({12, 5, 5}), 10);
}

TEST(HighestSamples, OfAUniverseSmallerThanABlockAreItsOwn) {
  const HighestSamples highest(with_bright_voxel(2, {3, 3, 3}));
  EXPECT_EQ(highest.edge_without({0, 0, 0}, 1999.0), 0);
  EXPECT_EQ(highest.edge_without({0, 0, 0}, 2000.0), 4);
}

}  // namespace
}  // namespace octotomy::voxel
