// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// A cup of 2 mm on a ball, from a height upward, and its seating from above.
Json cup_seating(const ScratchFolder& folder, double from_mm, const std::string& cup,
                 const std::string& direction = "[0, 0, -1]") {
  const std::string z = std::to_string(from_mm);
  const Plan plan = ball_plan(folder, R"(
      {"id": "above", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, )" + z + "], [30, " +
                                          z + R"(], [30, 30], [-30, 30]]]}]},
      {"id": "grown", "do": "offset", "object": "ball", "by_mm": 2},
      {"id": "blocked", "do": "shadow", "object": "ball", "direction": [0, 0, -1]},
      {"id": "cup", "do": "combine", "expression": ")" +
                                          cup + R"("},
      {"id": "seat", "do": "seating", "object": "cup", "against": ["ball"], "direction": )" +
                                          direction + "}");
  EvaluateOptions options;
  options.certify = false;
  return measurements_json(plan, evaluate(plan, options)).back();
}

TEST(SeatingStep, ACupBeyondTheEquatorBindsByItsUndercut) {
  const ScratchFolder folder;
  const Json seat = cup_seating(folder, -5.3, "(grown - ball) & above");
  EXPECT_EQ(seat.at("verdict"), "FAIL") << seat.dump(1);
  // The rim is narrower than the equator by this, and passes it on the last 5.3 mm.
  const double undercut_mm = 20.0 - std::sqrt(400.0 - 5.3 * 5.3);
  // The scan's ball is rough by a tenth of a millimetre.
  EXPECT_NEAR(seat.at("depth_mm").get<double>(), undercut_mm, 0.15) << seat.dump(1);
  const Json& found = seat.at("against")[0];
  EXPECT_TRUE(found.at("binds"));
  EXPECT_NEAR(found.at("at_mm")[2].get<double>(), 0.0, 2.0);
  EXPECT_NEAR(found.at("binds_from_mm").get<double>(), 5.3, 2.0);
  EXPECT_NEAR(found.at("voxel_depth_mm").get<double>(), undercut_mm, seat.at("voxel_error_mm").get<double>());
  EXPECT_NE(seat.at("findings")[0].get<std::string>().find("'cup' binds on 'ball'"), std::string::npos);
}

TEST(SeatingStep, WithoutTheShadowTheSameCupGoesOn) {
  const ScratchFolder folder;
  const Json seat = cup_seating(folder, -5.3, "(grown - blocked) & above");
  EXPECT_EQ(seat.at("verdict"), "PASS") << seat.dump(1);
  EXPECT_LT(seat.at("depth_mm").get<double>(), 0.05);
  // From the side it does not.
  const Json aside = cup_seating(folder, -5.3, "(grown - blocked) & above", "[1, 0, 0]");
  EXPECT_EQ(aside.at("verdict"), "FAIL") << aside.dump(1);
  EXPECT_GT(aside.at("depth_mm").get<double>(), 1.0);
}

TEST(SeatingStep, RefusesThePartItselfAndAMissingDirection) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "seating", "object": "ball", "against": ["ball"],
      "direction": [0, 0, 1]})")
                .find("names the part 'ball' itself"),
            std::string::npos);
  const std::string other = R"({"id": "other", "do": "move", "object": "ball", "translate_mm": [1, 0, 0]},)";
  EXPECT_NE(
      ball_refusal(folder, other + R"({"id": "s", "do": "seating", "object": "ball", "against": ["other"]})")
          .find("insertion direction is missing"),
      std::string::npos);
  EXPECT_NE(ball_refusal(folder, other + R"({"id": "s", "do": "seating", "object": "ball", "against": [],
      "direction": [0, 0, 1]})"),
            "");
}

}  // namespace
}  // namespace octotomy::planner
