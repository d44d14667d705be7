// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/operation/measure/result_json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

Json only_measurement(const Plan& plan) {
  return measurements_json(plan, evaluate(plan)).at(0);
}

TEST(CompareStep, AMovedBallIsAsFarAwayAsItWasMoved) {
  const ScratchFolder folder;
  const Json apart = only_measurement(ball_plan(folder, R"(
      {"id": "moved", "do": "move", "object": "ball", "translate_mm": [2, 0, 0]},
      {"id": "apart", "do": "compare", "a": "ball", "b": "moved", "tolerances_mm": [1, 2.1]})"));
  EXPECT_EQ(apart["id"], "apart");
  EXPECT_NEAR(apart["hausdorff_mm"].get<double>(), 2.0, 0.01);
  EXPECT_NEAR(apart["mean_mm"].get<double>(), 1.0, 0.02);  // |2 cos| over a sphere
  // A lens of two balls at a distance d: 1 - 3 d / 4 r + d^3 / 16 r^3 of one.
  EXPECT_NEAR(apart["dice"].get<double>(), 1.0 - 0.075 + 8.0 / (16 * 8000.0), 0.002);
  ASSERT_EQ(apart["a_to_b"]["bands"].size(), 2u);
  EXPECT_EQ(apart["a_to_b"]["bands"][1]["share_within"], 1.0);
}

TEST(CompareStep, AnObjectWithoutAMeshGivesNullAndAFinding) {
  const ScratchFolder folder;
  const Json none = only_measurement(ball_plan(folder, R"(
      {"id": "opened", "do": "segment", "scan": "ct", "window": "0:", "open_mm": 2},
      {"id": "apart", "do": "compare", "a": "ball", "b": "opened"})"));
  EXPECT_TRUE(none["mean_mm"].is_null());
  EXPECT_NE(none["findings"][0].get<std::string>().find("'opened' has no mesh"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
