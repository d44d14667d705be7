// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/region_grow.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/voxel/dense.h"

namespace octotomy::voxel {
namespace {

// Samples 1000, 1010 and 1020 by thirds along x within a box, air elsewhere, and a speck of 1000 apart.
Scene three_steps(const Universe& universe) {
  Scene scene;
  scene.lattice = universe.lattice();
  voxel::Int16Samples samples(scene.lattice.sample_count(), -1000);
  const int side = universe.side();
  const auto at = [&](int x, int y, int z) -> std::int16_t& {
    return samples[static_cast<std::size_t>(x + side * (y + side * z))];
  };
  for (int z = 4; z < 12; ++z)
    for (int y = 4; y < 12; ++y)
      for (int x = 2; x < 26; ++x) at(x, y, z) = static_cast<std::int16_t>(1000 + 10 * ((x - 2) / 8));
  at(1, 3, 3) = 1000;
  scene.samples = std::move(samples);
  return scene;
}

TEST(RegionGrow, StopsWhereSamplesLeaveTheTolerance) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree grey = grey_octree_of(universe, three_steps(universe));
  const auto count = [&](const GrowOptions& options) { return grow_region(grey, options).voxel_count(); };
  EXPECT_EQ(count({.seeds = {{3, 5, 5}}, .tolerance = 0}), 8U * 64);
  EXPECT_EQ(count({.seeds = {{3, 5, 5}}, .tolerance = 9.5}), 8U * 64);
  EXPECT_EQ(count({.seeds = {{3, 5, 5}}, .tolerance = 10}), 16U * 64);
  EXPECT_EQ(count({.seeds = {{12, 5, 5}}, .tolerance = 10}), 24U * 64);
  EXPECT_EQ(count({.seeds = {{3, 5, 5}, {25, 5, 5}}, .tolerance = 0}), 24U * 64);
  // The speck touches by a corner only.
  EXPECT_EQ(count({.seeds = {{3, 5, 5}}, .tolerance = 0, .neighbours = Neighbours::Edges}), 8U * 64);
  EXPECT_EQ(count({.seeds = {{3, 5, 5}}, .tolerance = 0, .neighbours = Neighbours::Corners}), 8U * 64 + 1);
  EXPECT_TRUE(grow_region(grey, {.seeds = {{1, 3, 3}}}).contains({1, 3, 3}));
}

TEST(RegionGrow, OfAirEndsWithTheScan) {
  const Universe small{4, glm::dmat4(1.0)};
  const Universe universe{5, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = small.lattice();
  scene.samples = voxel::Int16Samples(scene.lattice.sample_count(), -1000);
  const GreyOctree grey = grey_octree_of(universe, scene, -1024);
  EXPECT_EQ(grow_region(grey, {.seeds = {{3, 5, 5}}, .tolerance = 50}).voxel_count(), 16U * 16 * 16);
  EXPECT_THROW(grow_region(grey, {.seeds = {{20, 5, 5}}, .tolerance = 50}), std::invalid_argument);
}

TEST(RegionGrow, RefusesSeedsThatAreNoneOrOutside) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree grey = grey_octree_of(universe, three_steps(universe));
  EXPECT_THROW(grow_region(grey, {}), std::invalid_argument);
  EXPECT_THROW(grow_region(grey, {.seeds = {{32, 0, 0}}}), std::invalid_argument);
  EXPECT_THROW(grow_region(grey, {.seeds = {{3, 5, 5}}, .tolerance = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
