// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(DecimateStep, TheBallHasFewerTrianglesAndNearlyItsVolume) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "light", "do": "decimate", "object": "ball", "max_error_mm": 0.2})"));
  const Object& light = evaluation.object("light");
  expect_not_independent(light, ball_mm3(ball_radius_mm), 0.02);
  EXPECT_EQ(light.certificate->reasons.size(), 1U) << testing::PrintToString(light.certificate->reasons);
  EXPECT_LT(4 * light.mesh.whole->mesh().n_faces(), evaluation.object("ball").mesh.whole->mesh().n_faces());
  EXPECT_EQ(light.mesh.details["faces_before"], evaluation.object("ball").mesh.whole->mesh().n_faces());
}

TEST(DecimateStep, APartLostASurfacePushedOutAndNothingFail) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "top", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-15, 7], [15, 7], [15, 15], [-15, 15]]]}]},
      {"id": "bottom", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-15, 4], [15, 4], [15, -15], [-15, -15]]]}]},
      {"id": "two", "do": "combine", "expression": "ball & top | ball & bottom"},
      {"id": "light", "do": "decimate", "object": "two", "max_error_mm": 0.1},
      {"id": "without_top", "do": "combine", "expression": "light & bottom"},
      {"id": "moved", "do": "move", "object": "light", "translate_mm": [1, 0, 0]})",
                                                   small_radius_mm));
  const verify::Certificate& certificate = *evaluation.object("light").certificate;
  EXPECT_EQ(verify::to_string(certificate.verdict), "WARN") << testing::PrintToString(certificate.reasons);
  // A layer of twice the error could go unseen.
  EXPECT_NEAR(certificate.limit->volume_mm3, 2.0 * 0.1 * evaluation.object("two").mesh.whole->size().area_mm2,
              1e-3);
  for (const char* by : {"without_top", "moved", ""}) expect_fails_as(evaluation, "light", by);
  expect_fails_as(evaluation, "light", pushed_out(evaluation, "light", 1.0), "pushed out");
}

}  // namespace
}  // namespace octotomy::planner
