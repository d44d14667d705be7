// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(SmoothStep, TheVolumeStaysAndOneKernelAloneHasNoCertificate) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 5})"));
  const Object& even = evaluation.object("even");
  EXPECT_NEAR(even.mesh.within->measures().volume_mm3 / ball_mm3(ball_radius_mm), 1.0, 0.01);
  EXPECT_NEAR(even.voxel.measures.volume_mm3 / ball_mm3(ball_radius_mm), 1.0, 0.01);
  const double moved_mm = even.mesh.details["largest_move_mm"];
  EXPECT_GT(moved_mm, 0.0);
  EXPECT_LT(moved_mm, 1.0);
  EXPECT_FALSE(even.certificate);
  ASSERT_FALSE(even.findings.empty());
  EXPECT_NE(even.findings.back().find("no certificate"), std::string::npos) << even.findings.back();
}

TEST(SmoothStep, AChangeOfVolumeBeyondItsShareLeavesNoObject) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 1000,
      "max_volume_share": 1e-9})");
  EXPECT_THROW(evaluate(plan), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
