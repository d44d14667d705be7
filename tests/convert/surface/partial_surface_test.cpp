// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/partial_surface.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "brep/mesh/health.h"
#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"
#include "voxel/solid/digitise.h"

namespace octotomy::convert {
namespace {

using tests::unit_universe;

struct Errors {
  double volume = 0.0;  ///< relative
  double area = 0.0;
};

Errors ball_errors(int depth, double radius) {
  const voxel::Universe universe = unit_universe(depth);
  const glm::dvec3 centre = glm::dvec3(0.5 * universe.side()) + glm::dvec3(0.13, 0.29, -0.21);
  const brep::Triangles surface =
      isosurface(voxel::digitise_partial(universe, voxel::Sphere{centre, radius}));
  EXPECT_EQ(tests::fault_in_closedness(surface), std::nullopt);
  return {tests::volume_mm3(surface) / (4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3)) - 1.0,
          tests::area_mm2(surface) / (4.0 * std::numbers::pi * radius * radius) - 1.0};
}

TEST(PartialSurface, ABallOfTwentyFourVoxelsHasItsVolumeToAPerMilleAndItsAreaToFive) {
  const Errors errors = ball_errors(6, 24.0);
  EXPECT_NEAR(errors.volume, 0.0, 1e-3);
  EXPECT_NEAR(errors.area, 0.0, 5e-3);
}

TEST(PartialSurface, ABallsVolumeIsRightToATenthOfAPerMilleFromSixVoxelsOn) {
  // isosurface() of such shares is low by 0.8 / r^2: 2 % at six voxels, 0.14 % at 24.
  for (const double radius : {6.0, 9.0, 12.0, 24.0})
    EXPECT_NEAR(ball_errors(6, radius).volume, 0.0, 1e-4) << radius;
}

TEST(PartialSurface, AnObliqueCuboidKeepsItsVolume) {
  const voxel::Universe universe = unit_universe(6);
  const glm::dmat3 turn = glm::dmat3(0.8, 0.6, 0, -0.6, 0.8, 0, 0, 0, 1);
  const brep::Triangles surface = isosurface(
      voxel::digitise_partial(universe, voxel::OrientedBox{{31.3, 31.9, 32.2}, {14, 11, 17}, turn}));
  EXPECT_NEAR(tests::volume_mm3(surface) / (8.0 * 14 * 11 * 17), 1.0, 2e-3);
  EXPECT_TRUE(brep::health(surface).solid());
}

TEST(PartialSurface, ABallInTheCornerOfTheUniverseAndASingleVoxelAreClosed) {
  const voxel::Universe universe = unit_universe(4);
  for (const double radius : {0.4, 0.9, 8.0}) {
    const brep::Triangles surface =
        isosurface(voxel::digitise_partial(universe, voxel::Sphere{{1, 2, 1}, radius}));
    EXPECT_EQ(tests::fault_in_closedness(surface), std::nullopt) << radius;
  }
}

TEST(PartialSurface, HasTheSameBitsOnOneThreadAndMany) {
  const voxel::PartialOctree ball =
      voxel::digitise_partial(unit_universe(5), voxel::Sphere{{15.2, 16.1, 15.7}, 10.0});
  const brep::Triangles many = isosurface(ball);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(isosurface(ball).points_mm, many.points_mm);
}

}  // namespace
}  // namespace octotomy::convert
