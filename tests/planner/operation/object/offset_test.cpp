// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(OffsetStep, ABallGrowsAndShrinksByTheDistance) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "larger", "do": "offset", "object": "ball", "by_mm": 4},
      {"id": "smaller", "do": "offset", "object": "ball", "by_mm": -4})"));
  expect_certified(evaluation.object("larger"), ball_mm3(ball_radius_mm + 4.0), 0.02);
  expect_certified(evaluation.object("smaller"), ball_mm3(ball_radius_mm - 4.0), 0.03);
  for (const char* id : {"larger", "smaller"})
    EXPECT_TRUE(evaluation.object(id).certificate->independent()) << id;
}

TEST(OffsetStep, IsCombinedAndMovedAsAnyOtherObject) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "larger", "do": "offset", "object": "ball", "by_mm": 4},
      {"id": "cap", "do": "combine", "expression": "larger & high"},
      {"id": "moved", "do": "move", "object": "cap", "translate_mm": [0.4, 0.3, 0.2],
       "rotate": {"degrees": 10, "axis": [1, 0, 0]}})")));
  for (const char* id : {"cap", "moved"})
    expect_certified(evaluation.object(id), cap_mm3(ball_radius_mm + 4.0, 5.0), 0.02);
}

TEST(OffsetStep, HasItsOperandsDoubtByTheShareOfItsSurface) {
  const ScratchFolder folder;
  const auto size = [](const std::string& id) {
    return R"({"id": "size_)" + id + R"(", "do": "measure", "object": ")" + id + R"("})";
  };
  const Plan plan = ball_plan(folder, R"(
      {"id": "larger", "do": "offset", "object": "ball", "by_mm": 4},
      {"id": "fewer", "do": "decimate", "object": "larger", "max_error_mm": 0.2},
      {"id": "cap", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-40, 0], [40, 0], [40, 40], [-40, 40]]]}]},
      {"id": "half", "do": "combine", "expression": "fewer & cap"},)" +
                                          size("ball") + ", " + size("larger") + ", " + size("fewer") + ", " +
                                          size("half"));
  std::map<std::string, double> operands;
  double of_ball = 0.0;
  for (const auto& found : measurements_json(plan, evaluate(plan))) {
    const auto& volume = found.at("volume");
    if (found.at("object") == "ball") of_ball = volume.at("half_width");
    for (const auto& source : volume.at("sources"))
      if (source.at("name") == "operand")
        operands[found.at("object")] += source.at("half_width").get<double>();
  }
  ASSERT_GT(of_ball, 0.0);
  const auto operand = [&](const std::string& id) { return operands.contains(id) ? operands.at(id) : 0.0; };
  EXPECT_EQ(operand("ball"), 0.0);
  EXPECT_NEAR(operand("larger"), of_ball * std::pow((ball_radius_mm + 4.0) / ball_radius_mm, 2),
              0.1 * of_ball);
  EXPECT_GT(operand("fewer"), 0.9 * operand("larger"));
  // Half of its surface and the cut.
  EXPECT_GT(operand("half"), 0.6 * operand("fewer"));
  EXPECT_LT(operand("half"), 0.9 * operand("fewer"));
}

TEST(OffsetStep, ByNothingIsRefused) {
  const ScratchFolder folder;
  for (const char* nothing : {"0", "-0.0"})
    EXPECT_NE(ball_refusal(folder, R"({"id": "same", "do": "offset", "object": "ball", "by_mm": )" +
                                       std::string(nothing) + "}")
                  .find("step 'same', by_mm: 0 moves nothing"),
              std::string::npos)
        << nothing;
  EXPECT_EQ(ball_refusal(folder, R"({"id": "more", "do": "offset", "object": "ball", "by_mm": 0.1})"), "");
}

}  // namespace
}  // namespace octotomy::planner
