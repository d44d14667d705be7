// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_octree.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>
#include <tbb/global_control.h>

#include "voxel/solid/combine.h"
#include "voxel/tree/build.h"
#include "voxel/tree/grey_node.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

Scene ramp_scene(const Lattice& lattice, const glm::dvec4& plane) {
  Scene scene;
  scene.lattice = lattice;
  voxel::Int16Samples samples;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x)
        samples.push_back(static_cast<std::int16_t>(
            std::lround(glm::dot(plane, glm::dvec4(lattice.lps_mm(glm::dvec3(x, y, z)), 1.0)))));
  scene.samples = samples;
  return scene;
}

TEST(GreyOctree, KeepsEverySampleOfACoincidentScan) {
  const Universe universe{6, glm::dmat4(1.0)};
  const Scene scene = ramp_scene({{50, 33, 64}, universe.lps_from_voxel}, {3, -7, 11, 5});
  const GreyOctree grey = grey_octree_of(universe, scene, -1024);
  const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const bool inside = x < 50 && y < 33;
        const std::size_t i = static_cast<std::size_t>(x) +
                              50U * (static_cast<std::size_t>(y) + 33U * static_cast<std::size_t>(z));
        ASSERT_EQ(grey.sample({x, y, z}), inside ? samples[i] : -1024) << x << ' ' << y << ' ' << z;
      }
  EXPECT_EQ(grey.sample({-1, 0, 0}), -1024);
  EXPECT_EQ(grey.sample({64, 0, 0}), -1024);
}

TEST(GreyOctree, TakesSamplesOverThatLieWholeVoxelsAway) {
  const Scene scene = ramp_scene({{20, 25, 30}, glm::dmat4(1.0)}, {3, -7, 11, 5});
  Universe universe{5, glm::dmat4(1.0)};
  universe.lps_from_voxel[3] = glm::dvec4(-4, 3, -1, 1);
  const GreyOctree grey = grey_octree_of(universe, scene, -1024);
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const glm::ivec3 at = glm::ivec3(x, y, z) + glm::ivec3(-4, 3, -1);
        const bool inside = glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
                            glm::all(glm::lessThan(at, scene.lattice.dims));
        ASSERT_EQ(grey.sample({x, y, z}), inside ? 3 * at.x - 7 * at.y + 11 * at.z + 5 : -1024)
            << x << ' ' << y << ' ' << z;
        ASSERT_EQ(grey.scan().contains({x, y, z}), inside) << x << ' ' << y << ' ' << z;
      }
}

TEST(GreyOctree, RangesHoldTheSamplesBelowThemTightly) {
  const Universe universe{7, glm::dmat4(1.0)};
  const GreyOctree grey =
      grey_octree_of(universe, ramp_scene({{100, 128, 90}, universe.lps_from_voxel}, {3, -7, 11, 5}));
  for (int height = 2; height <= root_height(7); ++height) {
    const int edge = std::min(1 << (2 * height), 128);
    for (int z = 0; z < 128 / edge; ++z)
      for (int y = 0; y < 128 / edge; ++y)
        for (int x = 0; x < 128 / edge; ++x) {
          std::int16_t low = 32767;
          std::int16_t high = -32768;
          for (int k = 0; k < edge; ++k)
            for (int j = 0; j < edge; ++j)
              for (int i = 0; i < edge; ++i) {
                const std::int16_t value = grey.sample(edge * glm::ivec3(x, y, z) + glm::ivec3(i, j, k));
                low = std::min(low, value);
                high = std::max(high, value);
              }
          ASSERT_EQ(grey.range(height, {x, y, z}).low, low);
          ASSERT_EQ(grey.range(height, {x, y, z}).high, high);
        }
  }
}

TEST(GreyOctree, ResamplesALinearFieldExactlyFromAnyLattice) {
  // A linear field survives trilinear interpolation; an oblique, anisotropic, mirrored lattice shows every
  // mistake.
  glm::dmat4 lps_from_voxel(0.0);
  lps_from_voxel[0] = glm::dvec4(-0.8, 0.3, 0, 0);
  lps_from_voxel[1] = glm::dvec4(0.2, 0.9, 0.1, 0);
  lps_from_voxel[2] = glm::dvec4(0.1, -0.2, 2.0, 0);
  lps_from_voxel[3] = glm::dvec4(30, -20, -25, 1);
  const Lattice lattice{{60, 50, 26}, lps_from_voxel};
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const Scene scene = ramp_scene(lattice, {40, 60, -30, 500});
  const GreyOctree grey = grey_octree_of(universe, scene, -3000);
  int compared = 0;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const glm::dvec3 p_mm = universe.lattice().lps_mm(glm::dvec3(x, y, z));
        const glm::dvec3 p = lattice.voxel(p_mm);
        const bool well_inside = glm::all(glm::greaterThan(p, glm::dvec3(0.0))) &&
                                 glm::all(glm::lessThan(p, glm::dvec3(lattice.dims - 1)));
        const bool outside = glm::any(glm::lessThan(p, glm::dvec3(-0.5))) ||
                             glm::any(glm::greaterThan(p, glm::dvec3(lattice.dims) - 0.5));
        ASSERT_EQ(grey.scan().contains({x, y, z}), !outside);
        if (outside) {
          ASSERT_EQ(grey.sample({x, y, z}), -3000);
        }
        if (!well_inside) continue;
        ++compared;
        ASSERT_NEAR(grey.sample({x, y, z}), glm::dot(glm::dvec4(40, 60, -30, 500), glm::dvec4(p_mm, 1.0)),
                    1.001);
      }
  EXPECT_GT(compared, 10000);
}

TEST(GreyOctree, OfAUniverseSmallerThanABlockHasNoScanBeyondIt) {
  for (const int depth : {2, 3, 4}) {
    const Universe universe{depth, glm::dmat4(1.0)};
    const GreyOctree grey =
        grey_octree_of(universe, ramp_scene({{30, 30, 30}, glm::dmat4(1.0)}, {1, 2, 3, 4}));
    EXPECT_EQ(grey.scan().voxel_count(), std::uint64_t{1} << (3 * depth));
    EXPECT_TRUE(grey.scan() == Octree::full(universe));
  }
}

TEST(ScanBox, IsTheSmallestBoxOfSamplesOtherThanTheBackground) {
  const Universe universe{7, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = {{100, 90, 80}, universe.lps_from_voxel};
  Int16Samples samples(scene.lattice.sample_count(), -1024);
  const auto set = [&](int x, int y, int z) {
    samples[static_cast<std::size_t>(x + 100 * (y + 90 * z))] = 7;
  };
  set(3, 50, 21);
  set(97, 49, 60);
  scene.samples = samples;
  const GreyOctree grey = grey_octree_of(universe, scene);
  EXPECT_TRUE(scan_box(grey) == octree_of_box(universe, {3, 49, 21}, {97, 50, 60}));
  EXPECT_EQ(scan_box(grey).voxel_count(), 95U * 2 * 40);
  EXPECT_EQ(grey.scan().voxel_count(), 100U * 90 * 80);
}

TEST(GreyNode, BeyondTheScanIsEmptyInAWindowThatHoldsTheBackground) {
  const Universe universe{5, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = {{20, 18, 23}, universe.lps_from_voxel};
  scene.samples = Int16Samples(scene.lattice.sample_count(), -1000);
  const GreyOctree grey = grey_octree_of(universe, scene);
  const std::vector<LevelCount> levels = level_counts(grey, Window16{-1100, -800});
  const std::vector<LevelCount> expected = level_counts(octree_of_box(universe, {0, 0, 0}, {19, 17, 22}));
  ASSERT_EQ(levels.size(), expected.size());
  std::uint64_t voxels = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    EXPECT_EQ(levels[i].partial, expected[i].partial) << "level " << i + 1;
    voxels += levels[i].full << (3 * (4 - i));
  }
  EXPECT_EQ(voxels, 20U * 18 * 23);
  // A window of the background alone holds nothing.
  EXPECT_EQ(GreyNode::root(grey, Window16{-1024, -1024}).status(), Status::Partial);
  for (int child = 0; child < 8; ++child)
    EXPECT_NE(GreyNode::root(grey, Window16{-1024, -1024}).child(child).status(), Status::Full);
}

TEST(GreyOctree, HoldsSamplesThatAreNoWholeNumbersOrBeyondSixteenBitsInSteps) {
  const Universe universe{4, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = universe.lattice();
  for (const double most : {1e-4, 0.95, 5.0, 3071.5, 45000.0, 1e9}) {
    voxel::FloatSamples samples(4096);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = static_cast<float>(most * (static_cast<double>(i) / 4095.0 - 0.2) / 0.8);
    scene.samples = samples;
    const GreyOctree grey = grey_octree_of(universe, scene);
    int exponent = 0;
    EXPECT_EQ(std::frexp(grey.step(), &exponent), 0.5) << "a power of two";
    EXPECT_LE(grey.step(), most / 16000.0);
    for (int i = 0; i < 4096; i += 7)
      ASSERT_NEAR(grey.sample({i % 16, i / 16 % 16, i / 256}) * grey.step(),
                  static_cast<double>(samples[static_cast<std::size_t>(i)]), 0.5 * grey.step())
          << most;
    for (const double share : {0.25, 0.5, 0.7}) {
      const double low = share * most;
      const auto in = std::count_if(samples.begin(), samples.end(),
                                    [&](float sample) { return static_cast<double>(sample) >= low; });
      const Octree window = combine(universe, Expression(window_of(grey, low)));
      EXPECT_NEAR(static_cast<double>(window.voxel_count()), static_cast<double>(in), 1.0) << low;
    }
  }
  scene.samples = voxel::FloatSamples(4096, 40.0F);
  EXPECT_EQ(grey_octree_of(universe, scene).step(), 1.0) << "whole numbers stay as they are";
  scene.samples = voxel::FloatSamples(4096, -32768.0F);
  EXPECT_EQ(grey_octree_of(universe, scene).step(), 1.0) << "down to the least of 16 bits";
}

TEST(GreyOctree, TakesLittleMoreMemoryThanItsSamples) {
  const Universe universe{8, glm::dmat4(1.0)};
  const GreyOctree grey =
      grey_octree_of(universe, ramp_scene({{256, 256, 256}, universe.lps_from_voxel}, {1, 2, 3, 4}));
  EXPECT_LT(static_cast<double>(grey.bytes_memory()), 1.15 * 2.0 * 256 * 256 * 256);
}

// Samples of any value in a ball of so many of the height, and two values beside it.
Scene noisy_scene(const glm::ivec3& dims, double radius = 0.3) {
  Scene scene;
  scene.lattice = {dims, glm::dmat4(1.0)};
  Int16Samples samples;
  std::uint32_t state = 1;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        state = state * 1664525U + 1013904223U;
        const bool noisy = glm::distance(glm::dvec3(x, y, z), 0.5 * glm::dvec3(dims)) < radius * dims.y;
        samples.push_back(noisy ? static_cast<std::int16_t>(state >> 16) : std::int16_t(x < 80 ? -1000 : 7));
      }
  scene.samples = std::move(samples);
  return scene;
}

std::int16_t sample_of(const Scene& scene, const glm::ivec3& at) {
  const glm::ivec3& dims = scene.lattice.dims;
  return std::get<Int16Samples>(
      scene.samples)[static_cast<std::size_t>(at.x + dims.x * (at.y + dims.y * at.z))];
}

TEST(GreyOctree, SharesBricksOfOneValueAndKeepsAllSamplesOnAnyNumberOfThreads) {
  // More blocks along x than are taken over at once, and ends within blocks.
  const Scene scene = noisy_scene({700, 60, 50});
  Universe universe{10, glm::dmat4(1.0)};
  universe.lps_from_voxel[3] = glm::dvec4(-3, -5, -2, 1);
  std::uint64_t bytes = 0;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const GreyOctree grey = grey_octree_of(universe, scene, -1024);
    for (int z = -1; z < 54; ++z)
      for (int y = -1; y < 68; ++y)
        for (int x = -1; x < 706; ++x) {
          const glm::ivec3 at = glm::ivec3(x, y, z) - glm::ivec3(3, 5, 2);
          const bool inside = glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) &&
                              glm::all(glm::lessThan(at, scene.lattice.dims));
          ASSERT_EQ(grey.sample({x, y, z}), inside ? sample_of(scene, at) : -1024)
              << x << ' ' << y << ' ' << z << ", " << threads << " threads";
        }
    const auto brick_at = [&](int x, int z) { return &grey.brick({x, 1, z}); };
    EXPECT_EQ(brick_at(1, 1), brick_at(2, 1));   // -1000
    EXPECT_NE(brick_at(1, 1), brick_at(7, 1));   // 7
    EXPECT_EQ(brick_at(7, 1), brick_at(40, 1));  // two runs
    EXPECT_EQ(brick_at(0, 9), brick_at(50, 9));  // beyond the scan
    for (const glm::ivec3& block : {glm::ivec3(1, 1, 1), {7, 1, 1}, {21, 2, 1}, {0, 0, 0}}) {
      MinMax found{32767, -32768};
      for (const MinMax& leaf : grey.brick(block).leaf_range) found.widen(leaf);
      EXPECT_EQ(found.low, grey.range(2, block).low);
      EXPECT_EQ(found.high, grey.range(2, block).high);
    }
    if (bytes != 0) {
      EXPECT_EQ(grey.bytes_memory(), bytes);
    }
    bytes = grey.bytes_memory();
  }
  const GreyOctree all_noise = grey_octree_of(universe, noisy_scene({700, 60, 50}, 100.0), -1024);
  EXPECT_LT(bytes + 200 * sizeof(GreyBrick), all_noise.bytes_memory());
}

TEST(GreyOctree, HoldsTheBackgroundBeyondAUniverseThatIsSmallerThanABrick) {
  Scene scene = noisy_scene({20, 20, 20}, 100.0);
  for (const int depth : {2, 3}) {
    const GreyOctree grey = grey_octree_of(Universe{depth, glm::dmat4(1.0)}, scene, -1024);
    const int side = 1 << depth;
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const auto leaf = static_cast<std::size_t>(child_index(x >> 2, y >> 2, z >> 2));
          const auto place = static_cast<std::size_t>(child_index(x & 3, y & 3, z & 3));
          const bool within = std::max({x, y, z}) < side;
          ASSERT_EQ(grey.brick({0, 0, 0}).samples[leaf][place], within ? sample_of(scene, {x, y, z}) : -1024)
              << x << ' ' << y << ' ' << z << ", " << side << " voxels a side";
        }
  }
}

TEST(GreyOctree, ResamplesWholeNumbersAsItDoesTheSameFloats) {
  const Scene whole = noisy_scene({40, 37, 31});
  Scene floats = whole;
  const auto& samples = std::get<Int16Samples>(whole.samples);
  floats.samples = FloatSamples(samples.begin(), samples.end());
  for (const double edge : {0.37, 0.5, 1.0, 1.93}) {
    Universe universe{6, glm::dmat4(glm::dmat3(edge))};
    universe.lps_from_voxel[3] = glm::dvec4(-2.3, 0.25, -0.5, 1);
    const GreyOctree a = grey_octree_of(universe, whole), b = grey_octree_of(universe, floats);
    EXPECT_EQ(a.scan(), b.scan()) << edge;
    for (int z = 0; z < 64; ++z)
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
          ASSERT_EQ(a.sample({x, y, z}), b.sample({x, y, z}))
              << x << ' ' << y << ' ' << z << ", edge " << edge;
  }
}

}  // namespace
}  // namespace octotomy::voxel
