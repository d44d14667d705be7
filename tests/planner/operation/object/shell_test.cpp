// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(ShellStep, TheOuterLayerOfABallIsTheBallLessASmallerOne) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "crust", "do": "shell", "object": "ball", "thickness_mm": 8})"));
  expect_certified(evaluation.object("crust"), ball_mm3(ball_radius_mm) - ball_mm3(ball_radius_mm - 8.0),
                   0.03);
}

TEST(ShellStep, AThicknessOfNothingIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "shell", "object": "ball", "thickness_mm": 0})")
                .find("above zero"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
