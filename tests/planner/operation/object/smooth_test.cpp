// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(SmoothStep, TheVolumeStaysAndTheCertificateWarnsThatOneKernelMadeIt) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 5})"));
  const Object& even = evaluation.object("even");
  expect_not_independent(even, ball_mm3(ball_radius_mm), 0.01);
  int compared = 0;
  for (const verify::Comparison& comparison : even.certificate->comparisons)
    if (comparison.unit == "mm" && comparison.quantity.find("must lie") != std::string::npos) {
      EXPECT_LT(comparison.difference, 1e-11) << comparison.quantity;
      ++compared;
    }
  EXPECT_EQ(compared, 2);
  EXPECT_TRUE(even.certificate->resolved());
  const double moved_mm = even.mesh.details["largest_move_mm"];
  EXPECT_GT(moved_mm, 0.0);
  EXPECT_LT(moved_mm, 1.0);
  EXPECT_TRUE(even.findings.empty()) << testing::PrintToString(even.findings);
}

TEST(SmoothStep, APartLostASurfacePushedOutAndNothingFail) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "even", "do": "smooth", "object": "ball", "rounds": 5},
      {"id": "bottom", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-15, 7.5], [15, 7.5], [15, -15], [-15, -15]]]}]},
      {"id": "without_top", "do": "combine", "expression": "ball & bottom"},
      {"id": "moved", "do": "move", "object": "ball", "translate_mm": [0.5, 0, 0]})",
                                                   small_radius_mm));
  for (const char* by : {"without_top", "moved", ""}) expect_fails_as(evaluation, "even", by);
  expect_fails_as(evaluation, "even", pushed_out(evaluation, "even", 1.0), "pushed out");
}

TEST(SmoothStep, AChangeOfVolumeBeyondItsShareLeavesNoObject) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 1000,
      "max_volume_share": 1e-9})");
  EXPECT_THROW(evaluate(plan), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
