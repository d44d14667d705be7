// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

const char* const bent_line = R"("points_mm": [[-12, -18, 3], [-4, -20, 3], [4, -20, 5], [12, -18, 4]])";

std::string brush(const std::string& id, const std::string& stroke, const std::string& more = "") {
  return R"({"id": ")" + id + R"(", "do": "brush", "object": "ball", "strokes": [{)" + stroke + "}]" + more +
         "}";
}

std::string refused(const std::string& stroke) {
  const ScratchFolder folder;
  return ball_refusal(folder, brush("b", stroke));
}

double detail(const Object& object, const char* name) {
  return object.mesh.details[name].get<double>();
}

TEST(BrushStep, WithinTheBallADabTakesABallsVolumeInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, brush("holed", R"("points_mm": [[3, 2, 1]], "radius_mm": 8)")));
  const Object& holed = evaluation.object("holed");
  expect_certified(holed, ball_mm3(ball_radius_mm) - ball_mm3(8.0), 0.01);
  EXPECT_NEAR(detail(holed, "erased_mm3"), ball_mm3(8.0), 1e-6 * ball_mm3(8.0));
  EXPECT_EQ(holed.definition, "ball less 1 stroke of a brush");
  EXPECT_TRUE(holed.findings.empty()) << testing::PrintToString(holed.findings);
}

TEST(BrushStep, StrokesThatEraseAndPaintOverlapAlikeInBothKernels) {
  const ScratchFolder folder;
  const std::string stroke = bent_line + std::string(R"(, "radius_mm": 5)");
  const Evaluation evaluation = evaluate(
      ball_plan(folder, brush("erased", stroke) + ", " + brush("painted", stroke, R"(, "mode": "paint")")));
  const Object &erased = evaluation.object("erased"), &painted = evaluation.object("painted");
  expect_certified(erased, ball_mm3(ball_radius_mm) - detail(erased, "erased_mm3"), 0.01);
  expect_certified(painted, ball_mm3(ball_radius_mm) + detail(painted, "painted_mm3"), 0.01);
  EXPECT_NEAR(detail(erased, "erased_mm3") + detail(painted, "painted_mm3"), detail(erased, "brush_mm3"),
              1e-6 * detail(erased, "brush_mm3"));
}

TEST(BrushStep, WhatIsPaintedIsStatedAsNotMeasured) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(
      folder, brush("painted", R"("points_mm": [[0, -20, 0]], "radius_mm": 6)", R"(, "mode": "paint")")));
  const Object& painted = evaluation.object("painted");
  ASSERT_EQ(painted.findings.size(), 1u);
  EXPECT_NE(painted.findings.front().find("drawn by hand; no scan measured them"), std::string::npos)
      << painted.findings.front();
  EXPECT_NE(painted.voxel.lineage.find("no scan measured the painted material"), std::string::npos);
  EXPECT_NE(painted.mesh.lineage.find("no scan measured the painted material"), std::string::npos);
}

/// The slab's faces are parallel to the voxels' and do not lie between them.
TEST(BrushStep, ASlabInASliceIsCertified) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(
      folder, brush("cut", R"("points_mm": [[-9, -19, 4], [9, -19, 4]], "radius_mm": 5, "shape": "slab",
                          "normal": [0, 0, 2], "thickness_mm": 4)")));
  const Object& cut = evaluation.object("cut");
  expect_certified(cut, ball_mm3(ball_radius_mm) - detail(cut, "erased_mm3"), 0.01);
}

TEST(BrushStep, AnAlteredAnswerOfOneKernelIsFound) {
  const ScratchFolder folder;
  const auto evaluation = evaluate(ball_plan(
      folder,
      brush("right", bent_line + std::string(R"(, "radius_mm": 5)")) + ", " +
          brush("same", bent_line + std::string(R"(, "radius_mm": 5)")) + ", " +
          brush("wider", bent_line + std::string(R"(, "radius_mm": 6)")) + ", " +
          brush("short", R"("points_mm": [[-12, -18, 3], [-4, -20, 3], [4, -20, 5]], "radius_mm": 5)")));
  EXPECT_EQ(verify::to_string(altered_certificate(evaluation, "right", "same").verdict), "PASS");
  for (const char* other : {"wider", "short", "ball"})
    EXPECT_EQ(verify::to_string(altered_certificate(evaluation, "right", other).verdict), "FAIL") << other;
}

TEST(BrushStep, ABrushThatMeetsNothingIsAFinding) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, brush("b", R"("points_mm": [[29, 29, 29]], "radius_mm": 1)")));
  ASSERT_EQ(evaluation.object("b").findings.size(), 1u);
  EXPECT_NE(evaluation.object("b").findings.front().find("changes no voxel of 'ball'"), std::string::npos);
  ASSERT_EQ(evaluation.object("b").mesh.findings.size(), 1u);
  EXPECT_NE(evaluation.object("b").mesh.findings.front().find("no part of the surface of 'ball'"),
            std::string::npos);
}

TEST(BrushStep, RefusesWhatCannotBeDrawn) {
  const ScratchFolder folder;
  const auto expect_said = [](const std::string& refusal, const char* words) {
    EXPECT_NE(refusal.find(words), std::string::npos) << refusal;
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
  };
  expect_said(ball_refusal(folder, R"({"id": "b", "do": "brush", "object": "ball"})"),
              "'strokes' is missing");
  expect_said(refused(R"("points_mm": [])"), "points_mm");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "radius_mm": 0)"), "radius_mm");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "shape": "cube")"), "shape");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "shape": "slab", "thickness_mm": 2)"), "normal");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "shape": "slab", "normal": [0, 0, 1])"), "thickness_mm");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "shape": "slab", "normal": [0, 0, 0], "thickness_mm": 2)"),
              "normal");
  expect_said(refused(R"("points_mm": [[0, 0, 0]], "thickness_mm": 2)"), "set 'shape' to \"slab\"");
  expect_said(refused(R"("points_mm": [[0, 0, 0], [0, 0, 0.0001]])"), "0.001 mm apart");
  expect_said(refused(R"("points_mm": [[0, 0, 1e300]])"), "1000 m from the origin");
}

}  // namespace
}  // namespace octotomy::planner
