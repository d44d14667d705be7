// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/half_width.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "voxel/combine.h"

namespace octotomy::planner {
namespace {

voxel::Universe universe_of_64() {
  return voxel::universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
}

TEST(VolumeHalfWidth, HoldsTheTruthOfBallsWhereverTheyLieAndIsNotIdle) {
  int outside_of_a_tenth = 0;
  for (int i = 1; i <= 40; ++i) {
    const glm::dvec3 centre =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const double radius_mm = 9.0 + 0.23 * i;
    const voxel::Measures measures =
        voxel::measure(voxel::combine(universe_of_64(), voxel::Sphere{centre, radius_mm}));
    const double truth = 4.0 / 3.0 * std::numbers::pi * radius_mm * radius_mm * radius_mm;
    const HalfWidth found = volume_half_width(measures, {glm::dvec3(1.0)});
    EXPECT_LE(std::abs(measures.volume_mm3 - truth), found.value)
        << "radius " << radius_mm << " mm, number " << i;
    outside_of_a_tenth += std::abs(measures.volume_mm3 - truth) > 0.1 * found.value;
  }
  EXPECT_GT(outside_of_a_tenth, 15);
}

TEST(VolumeHalfWidth, CoarseSlicesWidenIt) {
  const voxel::Measures measures =
      voxel::measure(voxel::combine(universe_of_64(), voxel::Sphere{glm::dvec3(0.2), 20.0}));
  const double fine = volume_half_width(measures, {glm::dvec3(1.0), glm::dvec3(1.0)}).value;
  const double coarse = volume_half_width(measures, {glm::dvec3(1.0), {1, 1, 5}}).value;
  EXPECT_GT(coarse, 2.0 * fine);
}

TEST(WindowShift, OfARampIsTenUnitsByItsSlope) {
  // A ball whose samples fall by 40 a millimetre moves by a quarter of a millimetre for ten.
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({64, 64, 64}, glm::dvec3(1.0), glm::dvec3(-31.5));
  voxel::Int16Samples samples;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        samples.push_back(static_cast<std::int16_t>(
            std::lround(40.0 * (20.0 - glm::length(scene.lattice.lps_mm({x, y, z}) - glm::dvec3(0.3))))));
  scene.samples = std::move(samples);
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe_of_64(), scene, -2000);
  const std::optional<double> shift_mm = window_shift_mm({grey, 0.0});
  ASSERT_TRUE(shift_mm);
  EXPECT_NEAR(*shift_mm, 0.25, 0.03);
  EXPECT_FALSE(window_shift_mm({grey, 30000.0}));
}

}  // namespace
}  // namespace octotomy::planner
