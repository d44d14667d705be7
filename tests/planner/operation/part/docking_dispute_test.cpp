// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/docking_dispute.h"

#include <cmath>
#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

/// Six contacts of a box's corner: three on the floor, two on the wall y = 0, one on the wall x = 0.
std::vector<brep::DockingContact> corner() {
  return {{{10, 10, 0}, {0, 0, 1}, 0}, {{40, 10, 0}, {0, 0, 1}, 0}, {{10, 40, 0}, {0, 0, 1}, 0},
          {{10, 0, 20}, {0, 1, 0}, 0}, {{40, 0, 20}, {0, 1, 0}, 0}, {{0, 20, 20}, {1, 0, 0}, 0}};
}
const glm::dvec3 into_corner = -glm::normalize(glm::dvec3(1.0));
const std::vector<glm::dvec3> pushed{{20, 20, 22}};

TEST(DockingDispute, NamesTheOneContactThatTheOtherSetLacks) {
  for (std::size_t lost = 0; lost < 6; ++lost) {
    std::vector<brep::DockingContact> five = corner();
    five.erase(five.begin() + static_cast<std::ptrdiff_t>(lost));
    for (const bool whole_first : {true, false}) {
      const auto found = whole_first ? dispute(corner(), five, into_corner, pushed, {})
                                     : dispute(five, corner(), into_corner, pushed, {});
      ASSERT_TRUE(found) << lost;
      EXPECT_EQ(found->first_holds, whole_first) << lost;
      EXPECT_EQ(found->at_mm, corner()[lost].p_mm) << lost;
      EXPECT_FALSE(found->normals_deg) << lost;
      EXPECT_EQ(found->places, 1) << lost;
      EXPECT_NEAR(found->explained_deg, brep::worst_dockings(corner(), into_corner, pushed).front().angle_deg,
                  1e-6)
          << lost;
    }
  }
}

TEST(DockingDispute, NamesTheContactWhoseNormalTurned) {
  std::vector<brep::DockingContact> turned = corner();
  turned[5].normal = {0, 1, 0};
  const auto found = dispute(corner(), turned, into_corner, pushed, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->at_mm, corner()[5].p_mm);
  ASSERT_TRUE(found->normals_deg);
  EXPECT_NEAR(*found->normals_deg, 90.0, 1e-9);
}

TEST(DockingDispute, OfEqualContactsThereIsNone) {
  EXPECT_FALSE(dispute(corner(), corner(), into_corner, pushed, {}));
}

TEST(DockingDispute, WithoutContactsThePartFollowsThePush) {
  const auto found = dispute(corner(), {}, into_corner, pushed, {});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->first_holds);
  EXPECT_EQ(found->places, 6);
}

}  // namespace
}  // namespace octotomy::planner
