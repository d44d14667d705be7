// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(LandmarksStep, PointsTypedAndOfSlicersFileAreNamesForLaterSteps) {
  const ScratchFolder folder;
  std::ofstream(folder / "marks.mrk.json") << R"({"markups": [{"coordinateSystem": "RAS", "controlPoints": [
      {"label": "pns", "position": [-3, 0, 0], "positionStatus": "defined"}]}]})";
  const Plan plan = ball_plan(folder, R"({"id": "marks", "do": "landmarks", "file": "marks.mrk.json",
      "points": [{"name": "ans", "point_mm": [3, 4, 0]}]},
      {"id": "length", "do": "measure", "points_mm": ["ans", "pns"]},
      {"id": "corner", "do": "measure", "points_mm": ["ans", "pns", [3, 0, 9]]})");
  ASSERT_EQ(plan.landmarks.size(), 2u);
  EXPECT_EQ(plan.landmarks[1].p_mm, glm::dvec3(3, 0, 0));
  const auto measured = measurements_json(plan, evaluate(plan));
  EXPECT_NEAR(measured[0].at("distance_mm").get<double>(), 4.0, 1e-12);
  EXPECT_NEAR(measured[1].at("angle_deg").get<double>(), 90.0, 1e-9);
}

TEST(LandmarksStep, RefusalsPointAtThePlace) {
  const ScratchFolder folder;
  const auto says = [&](const std::string& step, const std::string& part) {
    const std::string text = ball_refusal(folder, step);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(R"({"id": "m", "do": "landmarks"})", "step 'm': names no point");
  says(R"({"id": "m", "do": "landmarks", "file": "none.json"})", "step 'm', file:");
  says(R"({"id": "m", "do": "landmarks", "points": [{"name": "a", "point_mm": [0, 0, 0]},
          {"name": "a", "point_mm": [1, 0, 0]}]})",
       "step 'm', points[1]: the landmark 'a' is named twice");
  says(R"({"id": "m", "do": "landmarks", "points": [{"name": "a@b", "point_mm": [0, 0, 0]}]})",
       "without '@'");
  says(R"({"id": "d", "do": "measure", "points_mm": ["ans", "pns"]})", "add a landmarks step");
  says(R"({"id": "m", "do": "landmarks", "points": [{"name": "a", "point_mm": [0, 0, 0]}]},
          {"id": "size", "do": "measure", "object": "m"})",
       "'m' is a landmarks step, not an object");
}

}  // namespace
}  // namespace octotomy::planner
