// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/gap.h"

#include <cmath>
#include <gtest/gtest.h>

#include "brep/mesh/triangles.h"
#include "planner/operation/measure/half_width.h"
#include "tests/brep/shapes.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using tests::universe_about_origin;

TEST(Gap, BetweenBallsIsWithinItsHalfWidthInBothKernelsHoweverTheyLie) {
  double largest_share = 0.0;
  for (int i = 1; i <= 30; ++i) {
    const glm::dvec3 chance =
        glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    const double truth_mm = 0.5 + 8.0 * chance.x;
    const glm::dvec3 along = glm::normalize(chance - 0.45), first = -11.0 * along + chance;
    const glm::dvec3 second = first + (16.0 + truth_mm) * along;
    const voxel::Octree a = voxel::combine(universe_about_origin(6), voxel::Sphere{first, 9.0}),
                        b = voxel::combine(universe_about_origin(6), voxel::Sphere{second, 7.0});
    const brep::Solid solid_a = brep::solid_of(brep::shapes::sphere(first, 9.0, 5)),
                      solid_b = brep::solid_of(brep::shapes::sphere(second, 7.0, 5));
    const Gap gap = gap_between(a, b, solid_a, solid_b);
    const HalfWidth width = gap_half_width(along, {glm::dvec3(1.0)}, {glm::dvec3(1.0)});
    EXPECT_NEAR(gap.voxel_mm, truth_mm, width.value) << "number " << i;
    ASSERT_TRUE(gap.mesh_mm);
    EXPECT_NEAR(*gap.mesh_mm, truth_mm, 0.05) << "number " << i;
    EXPECT_EQ(gap.overlap_mm3, 0.0);
    largest_share = std::max(largest_share, std::abs(gap.voxel_mm - truth_mm) / width.value);
  }
  EXPECT_GT(largest_share, 0.3) << "the half-width is idle";
}

TEST(Gap, OfObjectsThatOverlapIsNothingAndTheOverlapIsTold) {
  const glm::dvec3 second(10.0, 0.2, 0.1);
  const voxel::Octree a = voxel::combine(universe_about_origin(6), voxel::Sphere{glm::dvec3(0.0), 9.0}),
                      b = voxel::combine(universe_about_origin(6), voxel::Sphere{second, 7.0});
  const brep::Solid solid_a = brep::solid_of(brep::shapes::sphere(glm::dvec3(0.0), 9.0, 4)),
                    solid_b = brep::solid_of(brep::shapes::sphere(second, 7.0, 4));
  const Gap gap = gap_between(a, b, solid_a, solid_b);
  EXPECT_EQ(gap.voxel_mm, 0.0);
  EXPECT_EQ(*gap.mesh_mm, 0.0);
  EXPECT_GT(gap.overlap_mm3, 100.0);
  EXPECT_FALSE(gap_between(a, b, std::nullopt, solid_b).mesh_mm);
}

TEST(Gap, OfVoxelsSideBySideIsNothingAndOfOneBetweenIsOne) {
  const auto slab = [](double low, double high) {
    return voxel::combine(universe_about_origin(6), voxel::Box{{low, -10, -10}, {high, 10, 10}});
  };
  EXPECT_EQ(gap_between(slab(-10, 0), slab(0, 10), std::nullopt, std::nullopt).voxel_mm, 0.0);
  EXPECT_EQ(gap_between(slab(-10, 0), slab(1, 10), std::nullopt, std::nullopt).voxel_mm, 1.0);
}

}  // namespace
}  // namespace octotomy::planner
