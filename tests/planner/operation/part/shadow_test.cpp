// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;
using std::numbers::pi;

double half_ball_mm3() {
  return 0.5 * ball_mm3(ball_radius_mm);
}
double post_mm3(double length_mm) {
  return pi * ball_radius_mm * ball_radius_mm * length_mm;
}

TEST(ShadowStep, OfABallIsItsHalfAndARoundPostToItsFarEnd) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "oblique", "do": "shadow", "object": "ball", "direction": [1, -2, 0.5]},
      {"id": "viewed", "do": "shadow", "object": "ball", "seen_from": "anterior"},
      {"id": "longer", "do": "shadow", "object": "ball", "direction": [0, 0, 3], "beyond_mm": 4.3})"));
  expect_certified(evaluation.object("oblique"), half_ball_mm3() + post_mm3(20.0), 0.01);
  expect_certified(evaluation.object("viewed"), half_ball_mm3() + post_mm3(20.0), 0.03);
  expect_certified(evaluation.object("longer"), half_ball_mm3() + post_mm3(24.3), 0.03);
  for (const char* id : {"oblique", "viewed", "longer"})
    EXPECT_TRUE(evaluation.object(id).certificate->independent()) << id;
  // The view from anterior looks to the back, +y: the post lies behind.
  const double centroid_mm =
      (post_mm3(20.0) * 10.0 - half_ball_mm3() * 7.5) / (post_mm3(20.0) + half_ball_mm3());
  EXPECT_NEAR(evaluation.object("viewed").mesh.within->measures().centroid_mm->y, centroid_mm, 0.1);
  const auto& details = evaluation.object("viewed").mesh.details;
  EXPECT_NEAR(details.at("end_mm").get<double>(), 20.0, 0.1);
  EXPECT_NEAR(details.at("filled_mm3").get<double>(), post_mm3(20.0) - half_ball_mm3(), 200.0);
}

TEST(ShadowStep, EndsAtTheUniversesBorder) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "long", "do": "shadow", "object": "ball", "direction": [0, 0, -1], "beyond_mm": 30})"));
  // The universe reaches 32 mm about the ball's middle.
  expect_certified(evaluation.object("long"), half_ball_mm3() + post_mm3(32.0), 0.01);
}

TEST(ShadowStep, ATolerableUndercutIsLeftIn) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "snap", "do": "shadow", "object": "ball", "direction": [1, -2, 0.5], "tolerance_mm": 0.5})"));
  // The ball, and a post of 19.5 mm to its far end: within the ball is all of the post's half but a rim.
  const double post = pi * 19.5 * 19.5 * 20.0,
               rim = 2.0 / 3.0 * pi * std::pow(20.0 * 20.0 - 19.5 * 19.5, 1.5);
  expect_certified(evaluation.object("snap"), half_ball_mm3() + rim + post, 0.005);
}

TEST(ShadowStep, WhatIsCutByItCanBeSlidOn) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "blocked", "do": "shadow", "object": "ball", "direction": [0, 0, 1]},
      {"id": "grown", "do": "offset", "object": "ball", "by_mm": 4},
      {"id": "cup", "do": "combine", "expression": "grown - blocked"})"));
  // A ball of 24 mm less half a ball and a post of 20 mm. The post ends within the larger ball up to a radius
  // of sqrt(24^2 - 20^2), and beyond it at that ball's surface.
  const double larger = 24.0, flat2 = larger * larger - 400.0;
  const double post = pi * flat2 * 20.0 + 2.0 / 3.0 * pi * (8000.0 - std::pow(larger * larger - 400.0, 1.5));
  expect_certified(evaluation.object("cup"), ball_mm3(larger) - half_ball_mm3() - post, 0.02);
}

TEST(ShadowStep, RefusesADirectionThatIsMissingStatedTwiceOrUnknown) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& fields) {
    return ball_refusal(folder, R"({"id": "s", "do": "shadow", "object": "ball")" + fields + "}");
  };
  EXPECT_NE(refusal("").find("the insertion direction is missing: add 'direction'"), std::string::npos);
  EXPECT_NE(refusal(R"(, "direction": [0, 0, 1], "seen_from": "left")").find("leave out 'direction'"),
            std::string::npos);
  EXPECT_NE(refusal(R"(, "direction": [0, 0, 0])").find("has no direction"), std::string::npos);
  EXPECT_NE(refusal(R"(, "seen_from": "behind")").find("seen_from: no view 'behind'"), std::string::npos);
  EXPECT_NE(refusal(R"(, "direction": [0, 0, 1], "beyond_mm": -1)").find("beyond_mm: must be from 0"),
            std::string::npos);
  EXPECT_EQ(refusal(R"(, "seen_from": "35,15")"), "");
}

}  // namespace
}  // namespace octotomy::planner
