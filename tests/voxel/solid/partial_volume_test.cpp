// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/partial_volume.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

// Samples fall linearly through the surface, as a scan's do within a voxel of it.
GreyOctree ball(int side, double radius_mm, const glm::dvec3& centre_mm) {
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 32.0 / side);
  const Scene scene = tests::field_scene<std::int16_t>(universe.lattice(), [&](const glm::dvec3& p_mm) {
    return 1000 * std::clamp((radius_mm - glm::distance(p_mm, centre_mm)) / 2.0, -1.0, 1.0);
  });
  return grey_octree_of(universe, scene, -1024);
}

double truth(double radius_mm) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3);
}

TEST(PartialVolume, OfABallConvergesWithTheSquareOfTheVoxel) {
  const auto error = [](int side) {
    double sum = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double shift = 0.13 * i;
      sum += std::abs(partial_volume_mm3({ball(side, 11.3, {shift, -0.4 * shift, 0.7 * shift}), 0.0}) /
                          truth(11.3) -
                      1.0);
    }
    return sum / 6;
  };
  const double coarse = error(32);
  const double fine = error(64);
  // An interpolant of distances lies within a sphere by at most h^2 / 4 R, 3 h^2 / 4 R^2 of its volume.
  EXPECT_LT(coarse, 0.75 / (11.3 * 11.3));
  EXPECT_LT(fine, 0.75 * 0.25 / (11.3 * 11.3));
  EXPECT_GT(coarse / fine, 3.0) << coarse << " at 1 mm, " << fine << " at 0.5 mm";
}

TEST(PartialVolume, SeesAShiftOfAFifthOfAVoxelAndACountDoesNot) {
  const auto slab = [](double face_mm) {
    const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
    const Scene scene = tests::field_scene<std::int16_t>(universe.lattice(), [&](const glm::dvec3& p_mm) {
      const glm::dvec3 p = glm::abs(p_mm);
      return 600 * std::clamp(std::min({8.0 - p.y, 8.0 - p.z, face_mm - p.x}), -1.5, 1.5);
    });
    return grey_octree_of(universe, scene, -1024);
  };
  const double before = partial_volume_mm3({slab(5.0), 0.0});
  const double after = partial_volume_mm3({slab(5.2), 0.0});
  // The faces are exact; along the 128 mm of their edges an interpolant may cut up to an eighth of a cell.
  EXPECT_NEAR(after - before, 0.4 * 16 * 16, 128.0 / 8.0);
  EXPECT_EQ(combine(slab(5.0).universe(), Window{slab(5.1), 0.0}).voxel_count(),
            combine(slab(5.0).universe(), Window{slab(5.3), 0.0}).voxel_count());
}

TEST(PartialVolume, OfAShellBetweenTwoLevelsCountsCellsNoCornerOfWhichIsInside) {
  // Between -0.2 and 0.2 of full scale the shell is 0.8 mm thick: thinner than a voxel.
  const Window window{ball(32, 11.3, {0.2, 0.1, 0.3}), -200, 200};
  EXPECT_NEAR(partial_volume_mm3(window) / (truth(11.7) - truth(10.9)), 1.0, 0.02);
  EXPECT_LT(window.grey.universe().side(), 64);
}

TEST(PartialVolume, OfAWindowThatHoldsTheBackgroundEndsWithTheScan) {
  // A ball of 600 in air of -1000; the scan is smaller than its universe.
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  Lattice lattice = universe.lattice();
  lattice.dims = {27, 25, 29};
  const auto sample = [&](const glm::dvec3& p_mm) {
    return -200.0 + 800.0 * std::clamp(7.3 - glm::distance(p_mm, {-3, -4, -2}), -1.0, 1.0);
  };
  const GreyOctree grey = grey_octree_of(universe, tests::field_scene<std::int16_t>(lattice, sample), -1024);
  const double scan_mm3 = 27.0 * 25 * 29;
  const double ball_mm3 = partial_volume_mm3({grey, -200.0});
  EXPECT_NEAR(ball_mm3, truth(7.3), 0.01 * truth(7.3));
  EXPECT_DOUBLE_EQ(partial_volume_mm3({grey, -3000.0, 3000.0}), scan_mm3);
  EXPECT_NEAR(partial_volume_mm3({grey, -1100.0, -200.0}), scan_mm3 - ball_mm3, 1e-9 * scan_mm3);
}

TEST(PartialVolume, OfAnObjectThatEndsWithTheScanReachesHalfASampleBeyondItsLastSamples) {
  // A slab of 500 in air of -500 that fills the scan along x and y: 13.5 mm thick, at two places in the
  // universe.
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const auto slab_mm3 = [&](const glm::ivec3& dims, double low) {
    Lattice lattice = universe.lattice();
    lattice.dims = dims;
    const double first_mm = lattice.lps_mm(glm::dvec3(0.0)).z;
    const auto sample = [&](const glm::dvec3& p_mm) { return p_mm.z - first_mm < 13.0 ? 500.0 : -500.0; };
    return partial_volume_mm3(
        {grey_octree_of(universe, tests::field_scene<std::int16_t>(lattice, sample), -1024), low});
  };
  for (const glm::ivec3& dims : {glm::ivec3(20, 11, 25), glm::ivec3(32, 32, 32)})
    for (const double low : {-400.0, 0.0, 300.0})
      // The last sample inside is the 13th; the interpolant passes `low` beyond it, and the slab begins half
      // a sample before the first.
      EXPECT_NEAR(slab_mm3(dims, low), dims.x * dims.y * (12.5 + (500.0 - low) / 1000.0),
                  1e-6 * dims.x * dims.y)
          << dims.x << " at " << low;
}

TEST(PartialVolume, IsTheSameOnOneThreadAndTwo) {
  const Window window{ball(64, 9, {0.3, 0, 0}), 0.0};
  const double two = partial_volume_mm3(window);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(partial_volume_mm3(window), two);
}

}  // namespace
}  // namespace octotomy::voxel
