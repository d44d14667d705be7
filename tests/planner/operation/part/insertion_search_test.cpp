// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <numbers>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

Json search(const ScratchFolder& folder, const std::string& steps) {
  const Plan plan = ball_plan(folder, steps);
  EvaluateOptions options;
  options.certify = false;
  return measurements_json(plan, evaluate(plan, options)).back();
}

TEST(InsertionSearchStep, APostThatLeansIsPutOnAlongItsAxis) {
  const ScratchFolder folder;
  // A post of 8 mm about the axis (0, sin 20, cos 20): its own shadow, less the ends' corners.
  const Json found = search(folder, R"(
      {"id": "upright", "do": "mask", "regions": [{"view": "superior",
          "polygons_mm": [[[-4, -4], [4, -4], [4, 4], [-4, 4]]]}]},
      {"id": "straight", "do": "combine", "expression": "ball & upright"},
      {"id": "post", "do": "move", "object": "straight", "rotate": {"degrees": -20, "axis": [1, 0, 0]}},
      {"id": "way", "do": "insertion_search", "object": "post", "direction": [0, 0, -1],
       "within_deg": 40, "step_deg": 10})");
  EXPECT_NEAR(found.at("tilt_deg").get<double>(), 20.0, 0.01) << found.dump(1);
  EXPECT_NEAR(found.at("direction")[0].get<double>(), 0.0, 0.01);
  EXPECT_NEAR(std::abs(found.at("direction")[1].get<double>()), 0.342, 0.01);
  EXPECT_EQ(found.at("map").size(), 1u + 6u + 12u + 18u + 23u);
  EXPECT_GT(found.at("first").at("filled_mm3").get<double>(), 2.0 * found.at("filled_mm3").get<double>());
  EXPECT_NEAR(found.at("first").at("mesh_filled_mm3").get<double>() /
                  found.at("first").at("filled_mm3").get<double>(),
              1.0, 0.05);
  EXPECT_TRUE(found.at("findings").empty()) << found.at("findings");
}

TEST(InsertionSearchStep, RefusesAStepBeyondTheGrid) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "insertion_search", "object": "ball",
      "direction": [0, 0, 1], "within_deg": 5, "step_deg": 10})")
                .find("larger than 'within_deg'"),
            std::string::npos);
  EXPECT_NE(
      ball_refusal(folder, R"({"id": "s", "do": "insertion_search", "object": "ball"})").find("is missing"),
      std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
