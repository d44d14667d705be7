// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// The last step's answer of a plan on the ball of 20 mm.
Json last_of(const ScratchFolder& folder, const std::string& steps) {
  EvaluateOptions options;
  options.certify = false;
  const Plan plan = ball_plan(folder, steps);
  return measurements_json(plan, evaluate(plan, options)).back();
}

/// A mask of all that lies between two corners.
std::string box_mask(const std::string& name, const glm::dvec3& low, const glm::dvec3& high) {
  const auto square = [](double u0, double v0, double u1, double v1) {
    const std::string a = std::to_string(u0), b = std::to_string(v0), c = std::to_string(u1),
                      d = std::to_string(v1);
    return "[[" + a + "," + b + "],[" + c + "," + b + "],[" + c + "," + d + "],[" + a + "," + d + "]]";
  };
  return R"({"id": ")" + name + R"(", "do": "mask", "regions": [{"view": "anterior", "polygons_mm": [)" +
         square(low.x, low.z, high.x, high.z) + R"(]}, {"view": "left", "polygons_mm": [)" +
         square(low.y, low.z, high.y, high.z) + "]}]}, ";
}

std::string rocking(const std::string& part, const std::string& against, const std::string& more = "") {
  return R"({"id": "rocks", "do": "rocking", "object": ")" + part + R"(", "against": [")" + against +
         R"("], "direction": [0, 0, -1])" + more + "}";
}

TEST(RockingStep, ACupOnABallTurns) {
  const ScratchFolder folder;
  const Json rocks = last_of(folder, box_mask("above", {-25, -25, 8}, {25, 25, 30}) +
                                         R"({"id": "grown", "do": "offset", "object": "ball", "by_mm": 2},
      {"id": "cup", "do": "combine", "expression": "(grown - ball) & above"}, )" +
                                         rocking("cup", "ball"));
  EXPECT_EQ(rocks.at("verdict"), "WARN") << rocks.dump(1);
  EXPECT_LT(rocks.at("angle_deg").get<double>(), 1.0) << rocks.dump(1);
  EXPECT_EQ(rocks.at("gives_way").at("motion"), "turn");
  EXPECT_NE(rocks.at("findings")[0].get<std::string>().find("'cup' rocks on 'ball'"), std::string::npos);
  EXPECT_LT(std::abs(rocks.at("voxel_angle_deg").get<double>() - rocks.at("angle_deg").get<double>()),
            rocks.at("allowed_deg").get<double>());
}

/// A block of 16 x 16 mm that ends at z = 8, and a cap of 2 mm on its top and 6 mm down its four sides.
std::string capped_block() {
  return box_mask("column", {-8, -8, -8}, {8, 8, 8}) + box_mask("around", {-10, -10, 2}, {10, 10, 10}) +
         R"({"id": "block", "do": "combine", "expression": "ball & column"},
            {"id": "cap", "do": "combine", "expression": "(ball & around) - column"}, )";
}

TEST(RockingStep, ACapOverFourSidesHoldsByItsClosedForm) {
  // The worst push leans on two walls, each with q times its part along the direction. It is 2 mm above the
  // walls' upper ends and 8 mm above the lower ones. The top bears moments up to 8, then reactions of (2 q -
  // 8) / 6 at the lower ends of the opposite walls help. All reactions, 1 + 2 q + 4 (2 q - 8) / 6, reach
  // their limit of 10 at q = 4.3.
  const ScratchFolder folder;
  const Json rocks =
      last_of(folder, capped_block() + rocking("cap", "block", R"(, "at": [[0, 0, 10]], "radius_mm": 0)"));
  const double truth_deg = std::atan(4.3 * std::sqrt(2.0)) * 180.0 / std::acos(-1.0);
  EXPECT_EQ(rocks.at("verdict"), "PASS") << rocks.dump(1);
  EXPECT_NEAR(rocks.at("angle_deg").get<double>(), truth_deg, 0.02 * truth_deg);
  EXPECT_NEAR(rocks.at("voxel_angle_deg").get<double>(), truth_deg, rocks.at("allowed_deg").get<double>());
  EXPECT_LT(rocks.at("allowed_deg").get<double>(), 10.0);
}

TEST(RockingStep, AShellOnACornerHoldsByItsClosedForm) {
  // Three faces of a block's corner, each 10 mm wide, are pushed at 2 mm beyond the corner on their diagonal.
  // Reactions of two faces balance each other's moment while neither is 12 / 2 = 6 times the other.
  const ScratchFolder folder;
  const Json rocks = last_of(folder, box_mask("column", {-8, -8, -8}, {8, 8, 8}) +
                                         box_mask("around", {-2, -2, -2}, {10, 10, 10}) +
                                         R"({"id": "block", "do": "combine", "expression": "ball & column"},
      {"id": "shell", "do": "combine", "expression": "(ball & around) - column"},
      {"id": "rocks", "do": "rocking", "object": "shell", "against": ["block"], "direction": [-1, -1, -1],
        "at": [[10, 10, 10]], "radius_mm": 0})");
  const double truth_deg = std::asin(5.0 / std::sqrt(3.0 * 37.0)) * 180.0 / std::acos(-1.0);
  EXPECT_NEAR(rocks.at("angle_deg").get<double>(), truth_deg, 0.02 * truth_deg) << rocks.dump(1);
  EXPECT_NEAR(rocks.at("voxel_angle_deg").get<double>(), truth_deg, rocks.at("allowed_deg").get<double>());
  EXPECT_EQ(rocks.at("gives_way").at("motion"), "turn");
  EXPECT_EQ(rocks.at("verdict"), "PASS") << rocks.dump(1);
  EXPECT_LE(rocks.at("low_deg").get<double>(), rocks.at("angle_deg").get<double>());
  EXPECT_GT(rocks.at("low_deg").get<double>(), 1.0);
}

TEST(RockingStep, VoxelsOfAnotherPlaceAreFoundOut) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(
      folder, capped_block() +
                  R"({"id": "wrong", "do": "move", "object": "block", "translate_mm": [0, 0, -3]}, )" +
                  rocking("cap", "block", R"(, "at": [[0, 0, 10]], "radius_mm": 0)"));
  EvaluateOptions options;
  options.certify = false;
  Evaluation evaluation = evaluate(plan, options);
  ASSERT_EQ(measurements_json(plan, evaluation).back().at("verdict"), "PASS");
  std::size_t block = 0;
  while (evaluation.objects[block].id != "block") ++block;
  evaluation.objects.change(block).voxel = evaluation.objects.at("wrong").voxel;
  const Json spoiled = measurements_json(plan, evaluation).back();
  EXPECT_EQ(spoiled.at("verdict"), "WARN") << spoiled.dump(1);
  EXPECT_NE(spoiled.at("findings").back().get<std::string>().find("the kernels disagree"), std::string::npos);
}

TEST(RockingStep, SaysWhatIsWrongInOneSentence) {
  const ScratchFolder folder;
  const auto finding = [&](const std::string& steps) {
    const Json answer = last_of(folder, capped_block() + steps);
    EXPECT_EQ(answer.at("verdict"), "FAIL");
    EXPECT_TRUE(answer.at("angle_deg").is_null());
    EXPECT_EQ(answer.at("findings").size(), 1U);
    return answer.at("findings").at(0).get<std::string>();
  };
  EXPECT_NE(finding(R"({"id": "far", "do": "move", "object": "cap", "translate_mm": [0, 0, 9]}, )" +
                    rocking("far", "block"))
                .find("'far' touches 'block' nowhere within 0.4"),
            std::string::npos);
  EXPECT_NE(finding(rocking("cap", "block", R"(, "push": [0, 0, 1])"))
                .find("presses 'cap' onto nothing of 'block'"),
            std::string::npos);
  EXPECT_NE(
      finding(rocking("cap", "block", R"(, "at": [[40, 0, 0]])")).find("no surface of 'cap' faces the push"),
      std::string::npos);
  EXPECT_NE(ball_refusal(folder, rocking("ball", "ball")).find("names the part 'ball' itself"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, capped_block() + rocking("cap", "block", R"(, "contact_mm": 0)"))
                .find("contact_mm"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
