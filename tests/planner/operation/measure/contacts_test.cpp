// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <numbers>

#include "planner/operation/measure/near_surfaces.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;
Json map_of(const ScratchFolder& folder, const std::string& steps, bool meshes = true) {
  const Plan plan = ball_plan(folder, steps);
  EvaluateOptions options;
  options.meshes = meshes;
  options.certify = false;
  return measurements_json(plan, evaluate(plan, options)).back();
}

TEST(ContactsStep, ABallOnABallHasOnePlaceAndTheCapsArea) {
  const ScratchFolder folder;
  // Two balls of 20 mm whose surfaces are 0.25 mm apart, along an oblique line.
  const std::string steps = R"({"id": "other", "do": "move", "object": "ball",
      "translate_mm": [24.15, 32.2, 0]}, {"id": "map", "do": "contacts", "object": "ball", "against": "other",
      "within_mm": 1.0})";
  const Json map = map_of(folder, steps);
  ASSERT_EQ(map.at("contacts").size(), 1u);
  const Json& contact = map.at("contacts")[0];
  EXPECT_NEAR(contact.at("nearest_mm").get<double>(), 0.25, 0.1);
  EXPECT_NEAR(contact.at("voxel_nearest_mm").get<double>(), 0.25, contact.at("half_width_mm").get<double>());
  EXPECT_LT(glm::distance(glm::dvec3(contact["at_mm"][0], contact["at_mm"][1], contact["at_mm"][2]),
                          glm::dvec3(12, 16, 0)),
            2.0);
  // On one ball: the points at most 21 mm from the other's centre, 40.25 mm away: a cap of this height.
  const double d = 40.25, height = 20.0 - (d * d + 20.0 * 20.0 - 21.0 * 21.0) / (2.0 * d);
  EXPECT_NEAR(contact.at("area_mm2").get<double>(), 2.0 * std::numbers::pi * 20.0 * height, 6.0);
  EXPECT_EQ(contact.at("depth_mm"), 0.0);
  // Neighbouring points are one place, however near to each other places may be.
  const Json fine = map_of(folder, steps.substr(0, steps.rfind('}')) + R"(, "apart_mm": 0.001})");
  ASSERT_EQ(fine.at("contacts").size(), 1u);
  EXPECT_EQ(fine.at("contacts")[0].at("area_mm2"), contact.at("area_mm2"));
  const Json of_voxels = map_of(folder, steps, false);
  ASSERT_EQ(of_voxels.at("contacts").size(), 1u);
  EXPECT_TRUE(of_voxels.at("contacts")[0].at("area_mm2").is_null());
  EXPECT_NEAR(of_voxels.at("nearest_mm").get<double>(), 0.25, contact.at("half_width_mm").get<double>());
}

TEST(ContactsStep, OverlapIsADepthAndPlacesApartAreTwo) {
  const ScratchFolder folder;
  // A ball moved 38 mm: 2 mm deep. A board of two legs touches the ball at two places.
  const Json deep =
      map_of(folder, R"({"id": "other", "do": "move", "object": "ball", "translate_mm": [38, 0, 0]},
      {"id": "map", "do": "contacts", "object": "ball", "against": "other"})");
  ASSERT_EQ(deep.at("contacts").size(), 1u);
  EXPECT_NEAR(deep.at("contacts")[0].at("depth_mm").get<double>(), 2.0, 0.25);
  EXPECT_GT(deep.at("overlap_mm3").get<double>(), 0.0);
  EXPECT_EQ(deep.at("certain_count"), 1);
  const std::string legs = R"({"id": "left", "do": "mask", "regions": [{"view": "anterior", "polygons_mm":
      [[[-14, -30], [-8, -30], [-8, 30], [-14, 30]], [[8, -30], [14, -30], [14, 30], [8, 30]]]}]},
      {"id": "legs", "do": "combine", "expression": "ball & left"},
      {"id": "away", "do": "move", "object": "ball", "translate_mm": [0, 0, -35]},)";
  const Json two =
      map_of(folder, legs + R"({"id": "map", "do": "contacts", "object": "legs", "against": "away",
      "within_mm": 0.8})");
  EXPECT_EQ(two.at("contacts").size(), 2u) << two.dump();
  const Json one =
      map_of(folder, legs + R"({"id": "map", "do": "contacts", "object": "legs", "against": "away",
      "within_mm": 0.8, "apart_mm": 30})");
  EXPECT_EQ(one.at("contacts").size(), 1u);
}

TEST(ContactsStep, TellsWhereNothingTouchesAndRefusesItself) {
  const ScratchFolder folder;
  const Json map =
      map_of(folder, R"({"id": "other", "do": "move", "object": "ball", "translate_mm": [45, 0, 0]},
      {"id": "map", "do": "contacts", "object": "ball", "against": "other"})");
  EXPECT_TRUE(map.at("contacts").empty());
  EXPECT_NEAR(map.at("nearest_mm").get<double>(), 5.0, 0.1);
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "contacts", "object": "ball", "against": "ball"})")
                .find("step 'm', against: is the object itself"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
