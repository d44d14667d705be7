// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(DecimateStep, TheBallHasFewerTrianglesAndNearlyItsVolume) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "light", "do": "decimate", "object": "ball", "max_error_mm": 0.2})"));
  const Object& light = evaluation.object("light");
  expect_of_mesh(light, ball_mm3(ball_radius_mm), 0.02);
  EXPECT_LT(4 * light.mesh.whole->mesh().n_faces(), evaluation.object("ball").mesh.whole->mesh().n_faces());
  EXPECT_EQ(light.mesh.details["faces_before"], evaluation.object("ball").mesh.whole->mesh().n_faces());
}

}  // namespace
}  // namespace octotomy::planner
