// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/region_grow.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/voxel/dense.h"
#include "voxel/space/progress.h"

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

/// A ramp of 10 a voxel along x in 32 voxels, with a step of 1000 after the 20th.
Scene ramp_and_step(const Universe& universe) {
  Scene scene;
  scene.lattice = universe.lattice();
  voxel::Int16Samples samples(scene.lattice.sample_count());
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::int16_t>(10 * (i % 32) + (i % 32 >= 20 ? 1000 : 0));
  scene.samples = std::move(samples);
  return scene;
}

TEST(RegionGrow, ByItsRunningMeanFollowsARampToTheStep) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree grey = grey_octree_of(universe, ramp_and_step(universe));
  const GrowOptions from_end{.seeds = {{0, 5, 5}}, .tolerance = 105};
  // The seed's own sample reaches to 100, the mean of the region to its middle and 105 beyond.
  EXPECT_EQ(grow_region(grey, from_end).voxel_count(), 11U * 32 * 32);
  EXPECT_EQ(grow_by_running_mean(grey, from_end).voxel_count(), 20U * 32 * 32);
  // Neither passes the step; a tolerance that covers all samples does.
  EXPECT_EQ(grow_by_running_mean(grey, {.seeds = {{0, 5, 5}}, .tolerance = 2000}).voxel_count(), 32768U);
  // The mean of 0 admits 10 and is then 5; 20 is beyond the tolerance and no later round admits it.
  EXPECT_EQ(grow_by_running_mean(grey, {.seeds = {{0, 5, 5}}, .tolerance = 10}).voxel_count(), 2U * 32 * 32);
}

TEST(RegionGrow, ByItsRunningMeanIsThatOfAPlainFloodInRounds) {
  const Universe universe{4, glm::dmat4(1.0)};
  std::uint64_t most = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Scene scene;
    scene.lattice = universe.lattice();
    std::mt19937_64 random(seed);
    voxel::Int16Samples samples(scene.lattice.sample_count());
    for (std::int16_t& sample : samples) sample = static_cast<std::int16_t>(random() % 100);
    scene.samples = samples;
    const double tolerance = 15.0 + static_cast<double>(seed);
    const int most_axes = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 2 : 3;
    std::vector<char> in(samples.size(), 0);
    const auto index = [](int x, int y, int z) { return static_cast<std::size_t>(x + 16 * (y + 16 * z)); };
    in[index(8, 8, 8)] = 1;
    bool is_growing = true;
    while (is_growing) {
      std::int64_t count = 0, sum = 0;
      for (std::size_t i = 0; i < in.size(); ++i) count += in[i], sum += in[i] * samples[i];
      std::vector<char> next = in;
      for (int z = 0; z < 16; ++z)
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x)
            for (int c = -1; c <= 1; ++c)
              for (int b = -1; b <= 1; ++b)
                for (int a = -1; a <= 1; ++a) {
                  const glm::ivec3 to(x + a, y + b, z + c);
                  if (std::abs(a) + std::abs(b) + std::abs(c) > most_axes || in[index(x, y, z)] == 0 ||
                      glm::any(glm::lessThan(to, glm::ivec3(0))) ||
                      glm::any(glm::greaterThan(to, glm::ivec3(15))))
                    continue;
                  const std::size_t i = index(to.x, to.y, to.z);
                  if (static_cast<double>(std::abs(samples[i] * count - sum)) <=
                      tolerance * static_cast<double>(count))
                    next[i] = 1;
                }
      is_growing = next != in;
      in = next;
    }
    const Octree grown = grow_by_running_mean(grey_octree_of(universe, scene),
                                              {.seeds = {{8, 8, 8}},
                                               .tolerance = tolerance,
                                               .neighbours = most_axes == 1   ? Neighbours::Faces
                                                             : most_axes == 2 ? Neighbours::Edges
                                                                              : Neighbours::Corners});
    tests::Dense expected(16);
    for (std::size_t i = 0; i < in.size(); ++i) expected.voxels[i] = static_cast<std::uint8_t>(in[i]);
    EXPECT_TRUE(grown == tests::octree_of(universe, expected));
    most = std::max(most, grown.voxel_count());
  }
  EXPECT_GT(most, 1000U) << "no region grew";
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
  EXPECT_THROW(grow_by_running_mean(grey, {}), std::invalid_argument);
  EXPECT_THROW(grow_by_running_mean(grey, {.seeds = {{0, -1, 0}}}), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(grow_by_running_mean(grey, {.seeds = {{3, 5, 5}}, .stop = stop.get_token()}), Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
