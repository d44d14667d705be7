// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/recommended.h"

#include <gtest/gtest.h>

#include "voxel/measure/crofton.h"
#include "voxel/measure/flat_parts.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

TEST(Recommended, OfABoxAlongTheLatticeHoldsItsVolumeAndIsNotSevenPerCentLowInArea) {
  const voxel::Universe universe = voxel::universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
  const glm::dvec3 half(20.4, 15.3, 10.2);
  const voxel::Octree octree = voxel::combine(universe, voxel::Box{-half, half});
  const voxel::Measures measures = voxel::measure(octree);
  Digitised digitised{glm::dvec3(1.0)};
  digitised.flat_mm2 = voxel::flat_parts_mm2(octree);
  const verify::SizeIntervals found = intervals_of_count(measures, digitised, universe.lattice());
  const double volume_mm3 = 8.0 * half.x * half.y * half.z,
               area_mm2 = 8.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
  EXPECT_NEAR(found.volume_mm3.value, volume_mm3, found.volume_mm3.half_width);
  EXPECT_NEAR(found.area_mm2.value, area_mm2, found.area_mm2.half_width);
  EXPECT_LT(found.area_mm2.half_width, 0.1 * area_mm2);
  EXPECT_LT(measures.area_crofton13_mm2, found.area_mm2.value * 0.98);
  const glm::dvec3 seen = voxel::crofton13_of_flat(universe.lattice());
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(seen[axis], 0.92, 0.02);
}

TEST(Recommended, OfVoxelsThatPassOverAnObjectReachesWhatIsSeen) {
  const voxel::Universe universe = voxel::universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
  const verify::SizeIntervals found =
      intervals_of_count(voxel::measure(voxel::Octree::empty(universe)), {glm::dvec3(1.0)},
                         universe.lattice(), SeenSize{"mesh", 320.0, 3232.0});
  EXPECT_EQ(found.volume_mm3.half_width, 320.0);
  EXPECT_EQ(found.volume_mm3.sources.back().name, "mesh");
  EXPECT_EQ(found.area_mm2.half_width, 3232.0);
  EXPECT_EQ(found.area_mm2.sources.back().name, "mesh");
}

TEST(Recommended, HasItsUnitHalfWidthCoverageAndSources) {
  const MeasuredInterval found = measured(verify::Interval{12.0, 0.5, {{"window", "S d", 0.5}}}, "mm3");
  EXPECT_EQ(found.value, 12.0);
  EXPECT_EQ(found.unit, "mm3");
  EXPECT_EQ(found.half_width, 0.5);
  EXPECT_EQ(found.coverage, 0.99);
  ASSERT_EQ(found.sources.size(), 1U);
  EXPECT_EQ(found.sources[0].name, "window");
}

}  // namespace
}  // namespace octotomy::planner
