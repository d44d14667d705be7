// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(FindLandmarks, OfNothingAndOfWhatIsNoSkullTellsWhyAndThePlanGoesOn) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "none", "do": "combine", "expression": "ball - ball"},
      {"id": "of_none", "do": "find_landmarks", "object": "none"},
      {"id": "of_ball", "do": "find_landmarks", "object": "ball"})");
  const auto measured = measurements_json(plan, evaluate(plan));
  ASSERT_EQ(measured.size(), 2u);
  for (const auto& one : measured) {
    EXPECT_TRUE(one.at("landmarks").empty());
    ASSERT_EQ(one.at("findings").size(), 1u);
  }
  EXPECT_EQ(measured[0].at("findings")[0], "'none' is empty, so it has no landmarks");
  EXPECT_NE(measured[1].at("findings")[0].get<std::string>().find("check that the object is a skull"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
