// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/local_thickness.h"

#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using std::numbers::pi;

Universe half_millimetres(int depth) {
  Universe universe;
  universe.depth = depth;
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis][axis] = 0.5;
  return universe;
}

/// The mean over a box: the integral of Steiner's formula for what is left r inside, over the radii.
double box_mean_mm(const glm::dvec3& edges) {
  const double largest = std::min({edges.x, edges.y, edges.z});
  constexpr int steps = 2000;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double r = 0.5 * largest * (i + 0.5) / steps;
    const glm::dvec3 e = edges - 2 * r;
    sum += e.x * e.y * e.z + 2 * (e.x * e.y + e.y * e.z + e.z * e.x) * r + pi * (e.x + e.y + e.z) * r * r +
           4.0 / 3.0 * pi * r * r * r;
  }
  return largest / steps * sum / (edges.x * edges.y * edges.z);
}

TEST(VoxelThickness, OfPlatesAlongTheLatticeIsTheirVoxels) {
  for (const int voxels : {1, 2, 3, 6, 7}) {
    const double high = 10.0 + voxels - 0.5;
    const VoxelThickness found =
        local_thickness(combine(tests::unit_universe(6), Box{{3.5, 3.5, 9.5}, {59.5, 49.5, high}}));
    EXPECT_DOUBLE_EQ(found.median_mm, voxels);
    EXPECT_DOUBLE_EQ(found.largest_mm, voxels);
    ASSERT_TRUE(found.thinnest_wall) << voxels;
    EXPECT_NEAR(found.surface[*found.thinnest_wall].thickness_mm, voxels, 1.01) << voxels;
  }
}

TEST(VoxelThickness, OfABoxFollowsSteinersFormula) {
  const VoxelThickness found =
      local_thickness(combine(half_millimetres(7), Box{{2.25, 2.25, 2.25}, {22.25, 32.25, 42.25}}));
  EXPECT_DOUBLE_EQ(found.largest_mm, 20.0);
  EXPECT_NEAR(found.mean_mm, box_mean_mm({20, 30, 40}), found.mean_half_width_mm);
  EXPECT_LT(found.mean_half_width_mm, 0.8);
}

TEST(VoxelThickness, OfABallIsItsDiameterWhereverItLies) {
  for (int i = 1; i <= 6; ++i) {
    const glm::dvec3 off = glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const double radius = 7.0 + 1.3 * i;
    const VoxelThickness found = local_thickness(
        combine(tests::unit_universe(6), Sphere{glm::dvec3(31) + off, radius}), {.samples = 1000});
    EXPECT_NEAR(found.mean_mm, 2 * radius, found.mean_half_width_mm) << i;
    EXPECT_NEAR(found.largest_mm, 2 * radius, 1.0) << i;
    EXPECT_NEAR(found.surface[found.thinnest_wall.value()].thickness_mm, 2 * radius, 2.0) << i;
  }
}

TEST(VoxelThickness, OfAShellIsTheDifferenceOfItsRadii) {
  const glm::dvec3 middle(31.3, 30.8, 31.6);
  const Expression shell = Expression(Sphere{middle, 26.0}) - Expression(Sphere{middle, 20.0});
  const VoxelThickness found = local_thickness(combine(tests::unit_universe(6), shell));
  EXPECT_NEAR(found.mean_mm, 6.0, found.mean_half_width_mm);
  EXPECT_LT(found.deviation_mm, 0.5);
  EXPECT_LT(found.mean_half_width_mm, 1.3);
  EXPECT_NEAR(found.surface[found.thinnest_wall.value()].thickness_mm, 6.0, 1.2);
}

TEST(VoxelThickness, OfAnObliquePlateConvergesWithTheVoxel) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, 4)), middle(16);
  const auto plate = [&](const Universe& universe) {
    const double at = glm::dot(normal, middle);
    return local_thickness(combine(universe, Expression(Box{{4, 4, 4}, {28, 28, 28}}) &
                                                 HalfSpace{normal, at + 2.0} & HalfSpace{-normal, 2.0 - at}))
        .median_mm;
  };
  EXPECT_NEAR(plate(tests::unit_universe(5)), 4.0, 1.0);
  EXPECT_NEAR(plate(half_millimetres(6)), 4.0, 0.3);
}

TEST(VoxelThickness, TheThinnestWallAloneIsTheSame) {
  const Universe universe = tests::unit_universe(6);
  const Expression blocks = Expression(Box{{3.5, 3.5, 9.5}, {40.5, 49.5, 20.5}}) |
                            Expression(Box{{50.5, 3.5, 9.5}, {53.5, 49.5, 50.5}}) |
                            Expression(Sphere{{20.0, 20.0, 45.0}, 9.3});
  for (const Expression& solid : {blocks, blocks - Expression(Sphere{{20.0, 20.0, 45.0}, 5.2}),
                                  Expression(Sphere{{30, 31, 32}, 12.4})}) {
    const Octree octree = combine(universe, solid);
    const VoxelThickness all = local_thickness(octree);
    const std::optional<ThicknessAtVoxel> alone = thinnest_wall(octree);
    ASSERT_TRUE(all.thinnest_wall);
    ASSERT_TRUE(alone);
    EXPECT_EQ(alone->voxel, all.surface[*all.thinnest_wall].voxel);
    EXPECT_EQ(alone->thickness_mm, all.surface[*all.thinnest_wall].thickness_mm);
    EXPECT_TRUE(alone->is_wall);
  }
  EXPECT_FALSE(thinnest_wall(Octree::empty(universe)));
}

TEST(VoxelThickness, IsTheSameOnOneThread) {
  const Octree ball = combine(tests::unit_universe(5), Sphere{{15.2, 15.3, 15.4}, 9.0});
  const VoxelThickness many = local_thickness(ball);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const VoxelThickness single = local_thickness(ball);
  EXPECT_EQ(many.mean_mm, single.mean_mm);
  EXPECT_EQ(many.deviation_mm, single.deviation_mm);
  EXPECT_EQ(many.thinnest_wall, single.thinnest_wall);
}

TEST(VoxelThickness, OfNothingIsNoneAndRefusesAndStops) {
  const Octree nothing = Octree::empty(tests::unit_universe(5));
  EXPECT_EQ(local_thickness(nothing).largest_mm, 0.0);
  EXPECT_THROW(local_thickness(nothing, {.samples = 1}), std::invalid_argument);
  EXPECT_THROW(local_thickness(nothing, {.wall_angle_deg = 180}), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(local_thickness(Octree::full(tests::unit_universe(3)), {.progress = {stop.get_token(), {}}}),
               Stopped);
}

}  // namespace
}  // namespace octotomy::voxel
