// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(FillStep, AHollowBallIsFullAgainInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "hollow", "do": "shell", "object": "ball", "thickness_mm": 6},
      {"id": "full", "do": "fill", "object": "hollow"})"));
  EXPECT_LT(evaluation.object("hollow").voxel.measures.volume_mm3, 0.8 * ball_mm3(ball_radius_mm));
  expect_certified(evaluation.object("full"), ball_mm3(ball_radius_mm), 0.01);
  EXPECT_EQ(evaluation.object("full").mesh.details["cavities"], 1u);
}

}  // namespace
}  // namespace octotomy::planner
