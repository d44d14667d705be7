// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/room.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

voxel::Universe of_64_mm() {
  return voxel::universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
}

TEST(WithRoom, IsTheSameUniverseForABoxInIt) {
  const voxel::Universe universe = of_64_mm();
  EXPECT_EQ(with_room(universe, {glm::dvec3(-32.0), glm::dvec3(32.0)}), universe);
}

TEST(WithRoom, ContainsTheBoxAndTheOldUniverseOnTheSameVoxels) {
  const voxel::Universe universe = of_64_mm();
  const voxel::Box far{{-40.2, -3.0, 10.0}, {-30.0, 80.7, 20.0}};
  const std::optional<voxel::Universe> larger = with_room(universe, far);
  ASSERT_TRUE(larger);
  EXPECT_EQ(larger->side(), 128);
  const voxel::Box box = voxel::bounds(larger->lattice());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(box.low_mm[axis], std::min(-32.0, far.low_mm[axis])) << axis;
    EXPECT_GE(box.high_mm[axis], std::max(32.0, far.high_mm[axis])) << axis;
  }
  EXPECT_TRUE(voxel::whole_voxel_offset(glm::inverse(universe.lps_from_voxel) * larger->lps_from_voxel));
}

TEST(WithRoom, GrowsToFourTimesTheSideAndNoFarther) {
  const voxel::Universe universe = of_64_mm();
  EXPECT_EQ(with_room(universe, {glm::dvec3(0.0), glm::dvec3(220.0, 0.0, 0.0)})->side(), 256);
  EXPECT_FALSE(with_room(universe, {glm::dvec3(0.0), glm::dvec3(230.0, 0.0, 0.0)}));
}

}  // namespace
}  // namespace octotomy::planner
