// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/partial_volume.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "voxel/combine.h"

namespace octotomy::voxel {
namespace {

// Samples fall linearly through the surface, as a scan's do within a voxel of it.
GreyOctree ball(int side, double radius_mm, const glm::dvec3& centre_mm) {
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 32.0 / side);
  Scene scene;
  scene.lattice = universe.lattice();
  voxel::Int16Samples samples;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double depth = radius_mm - glm::distance(scene.lattice.lps_mm({x, y, z}), centre_mm);
        samples.push_back(static_cast<std::int16_t>(std::lround(1000 * std::clamp(depth / 2.0, -1.0, 1.0))));
      }
  scene.samples = std::move(samples);
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
    Scene scene;
    scene.lattice = universe.lattice();
    voxel::Int16Samples samples;
    for (int z = 0; z < 32; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const glm::dvec3 p = glm::abs(scene.lattice.lps_mm({x, y, z}));
          const double depth = std::min({8.0 - p.y, 8.0 - p.z, face_mm - p.x});
          samples.push_back(static_cast<std::int16_t>(std::lround(600 * std::clamp(depth, -1.5, 1.5))));
        }
    scene.samples = std::move(samples);
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

TEST(PartialVolume, RefusesAWindowThatHoldsWhatIsBeyondTheScan) {
  EXPECT_THROW(partial_volume_mm3({ball(32, 5, {}), -2000, 0}), std::invalid_argument);
}

TEST(PartialVolume, IsTheSameOnOneThreadAndTwo) {
  const Window window{ball(64, 9, {0.3, 0, 0}), 0.0};
  const double two = partial_volume_mm3(window);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(partial_volume_mm3(window), two);
}

}  // namespace
}  // namespace octotomy::voxel
