// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// The volume of a ball between two planes at distances a < b from its centre.
double slice_mm3(double r, double a, double b) {
  return M_PI * (r * r * (b - a) - (b * b * b - a * a * a) / 3.0);
}

TEST(SawStep, AKerfTakesASliceOfTheBallInBothKernels) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "sawn", "do": "saw", "object": "ball",
      "line_mm": [[-40, -40, 3], [40, -40, 3]], "direction": [0, 1, 0], "depth_mm": 80, "kerf_mm": 4})");
  const Evaluation evaluation = evaluate(plan);
  const double truth = ball_mm3(ball_radius_mm) - slice_mm3(ball_radius_mm, 1.0, 5.0);
  expect_certified(evaluation.object("sawn"), truth, 0.01);
  EXPECT_NEAR(evaluation.object("sawn").mesh.details["sawn_away_mm3"].get<double>(),
              slice_mm3(ball_radius_mm, 1.0, 5.0), 20.0);
  EXPECT_EQ(evaluation.object("sawn").mesh.details["pieces"].size(), 2u);
}

TEST(SawStep, ABentLineIsMitredAlikeInBothKernels) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "sawn", "do": "saw", "object": "ball",
      "line_mm": [[-40, -40, 0], [0, -40, 8], [40, -40, -5]], "direction": [0.1, 1, 0.2], "depth_mm": 45,
      "kerf_mm": 3})");
  const Evaluation evaluation = evaluate(plan);
  const Object& sawn = evaluation.object("sawn");
  ASSERT_TRUE(sawn.certificate);
  EXPECT_EQ(verify::to_string(sawn.certificate->verdict), "PASS")
      << testing::PrintToString(sawn.certificate->reasons);
  EXPECT_LT(sawn.voxel.measures.volume_mm3, 0.97 * ball_mm3(ball_radius_mm));
}

TEST(SawStep, ALineOfOnePointOrWithoutDirectionIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "saw", "object": "ball", "line_mm": [[0, 0, 0]],
      "direction": [0, 1, 0]})")
                .find("at least 2"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "saw", "object": "ball",
      "line_mm": [[0, 0, 0], [1, 0, 0]], "direction": [0, 0, 0]})")
                .find("no direction"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "saw", "object": "ball",
      "line_mm": [[0, 0, 0], [1, 0, 0]]})")
                .find("direction: is missing"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "saw", "object": "ball",
      "line_mm": [[0, 0, 0], [0, 9, 0]], "direction": [0, 1, 0]})")
                .find("distinct"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
