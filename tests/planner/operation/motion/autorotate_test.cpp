// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using namespace tests;

// The hinge lies 40 mm behind, between the caps.

bool overlap(const Evaluation& evaluation, const std::string& a, const std::string& b) {
  return !voxel::combine(evaluation.universe, voxel::Expression(evaluation.object(a).voxel.octree) &
                                                  voxel::Expression(evaluation.object(b).voxel.octree))
              .is_empty();
}

TEST(AutorotateStep, TheLowerJawClosesToFirstContactAndNoFurther) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "closed", "do": "autorotate", "object": "lower", "against": "upper",
          "condyles": [[-20, 40, 0], [20, 40, 0]]},
      {"id": "further", "do": "move", "object": "closed", "rotate": {"degrees": 1,
          "through": [[20, 40, 0], [-20, 40, 0]]}})")));
  // The front edges are farthest from the hinge and meet first: twice the angle at which they are seen.
  const double front_mm = 40.0 + std::sqrt(ball_radius_mm * ball_radius_mm - 25.0);
  const double truth_deg = 2.0 * glm::degrees(std::atan2(5.0, front_mm));
  const auto& told = evaluation.object("closed").moved->details;
  EXPECT_NEAR(told.at("closed_deg").get<double>(), truth_deg, glm::degrees(1.5 / front_mm));
  EXPECT_LT(told.at("contact_mm")[1].get<double>(), -15.0) << "at the front";
  EXPECT_FALSE(overlap(evaluation, "closed", "upper"));
  EXPECT_TRUE(overlap(evaluation, "further", "upper"));
  expect_certified(evaluation.object("closed"), cap_mm3(ball_radius_mm, 5.0), 0.05);
}

TEST(AutorotateStep, AJawThatOverlapsOpens) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "deep", "do": "move", "object": "lower", "translate_mm": [0, 0, 12]},
      {"id": "freed", "do": "autorotate", "object": "deep", "against": "upper",
          "condyles": [[-20, 40, 0], [20, 40, 0]]})")));
  EXPECT_LT(evaluation.object("freed").moved->details.at("closed_deg").get<double>(), -0.5);
  EXPECT_TRUE(overlap(evaluation, "deep", "upper"));
  EXPECT_FALSE(overlap(evaluation, "freed", "upper"));
}

TEST(AutorotateStep, RefusalsPointAtThePlace) {
  const ScratchFolder folder;
  EXPECT_NE(
      ball_refusal(folder, ball_caps(R"({"id": "c", "do": "autorotate", "object": "lower", "against": "lower",
      "condyles": [[-20, 40, 0], [20, 40, 0]]})"))
          .find("step 'c', against: is the object itself"),
      std::string::npos);
  EXPECT_NE(
      ball_refusal(folder, ball_caps(R"({"id": "c", "do": "autorotate", "object": "lower", "against": "upper",
      "condyles": [[0, 40, 0], [1, 40, 0]]})"))
          .find("step 'c', condyles: lie within 10 mm"),
      std::string::npos);
  try {
    evaluate(
        ball_plan(folder, ball_caps(R"({"id": "c", "do": "autorotate", "object": "lower", "against": "upper",
        "condyles": [[-20, 40, 0], [20, 40, 0]], "most_deg": 2})")));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("raise 'most_deg'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
