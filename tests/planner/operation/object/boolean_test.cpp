// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(BooleanStep, ACertifiedCapIsWhatCombineMakesOfTheSameOperands) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "cap", "do": "boolean", "a": "ball", "op": "intersection", "b": "high"},
      {"id": "rest", "do": "boolean", "a": "ball", "op": "difference", "b": "high"},
      {"id": "whole", "do": "boolean", "a": "cap", "op": "union", "b": "rest"},
      {"id": "same", "do": "combine", "expression": "ball & high"})")));
  const double cap = cap_mm3(ball_radius_mm, 5.0), ball = ball_mm3(ball_radius_mm);
  expect_certified(evaluation.object("cap"), cap, 0.02);
  expect_certified(evaluation.object("rest"), ball - cap, 0.02);
  expect_certified(evaluation.object("whole"), ball, 0.02);
  const Object &made = evaluation.object("cap"), &same = evaluation.object("same");
  EXPECT_EQ(made.voxel.octree, same.voxel.octree);
  EXPECT_EQ(made.certificate->tolerance_mm3, same.certificate->tolerance_mm3);
  EXPECT_EQ(made.certificate->independent(), same.certificate->independent());
  EXPECT_EQ(made.definition, "the intersection of ball and high");
}

TEST(BooleanStep, FurtherOperandsAreAllTakenFromTheFirst) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "belt", "do": "boolean", "a": "ball", "op": "difference", "b": "high", "with": ["low"]},
      {"id": "same", "do": "combine", "expression": "ball - high - low"})")));
  EXPECT_EQ(evaluation.object("belt").definition, "the difference of ball, high and low");
  EXPECT_EQ(evaluation.object("belt").voxel.octree, evaluation.object("same").voxel.octree);
}

TEST(BooleanStep, ExactNumbersProveTheVolumesAndTakeTwoOperandsOnly) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "cap", "do": "boolean", "a": "ball", "op": "intersection", "b": "high", "exact": true})")));
  const auto& proof = evaluation.object("cap").mesh.details.at("exact");
  EXPECT_NEAR(proof.at("a_mm3").get<double>() + proof.at("b_mm3").get<double>(),
              proof.at("union_mm3").get<double>() + proof.at("intersection_mm3").get<double>(), 1e-6);
  EXPECT_NE(ball_refusal(folder, ball_caps(R"({"id": "cap", "do": "boolean", "a": "ball", "op": "union",
                                               "b": "high", "with": ["ball"], "exact": true})"))
                .find("leave 'with' out"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
