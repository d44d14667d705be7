// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(MaskStep, RegionsOnSlicesCutTheVoxelsAndSayThatThereIsNoMesh) {
  const TestFolder folder;
  std::ofstream(folder / "slices.json") << R"({"view": "inferior", "slices": [
      {"position_mm": -30, "polygons_mm": [[[0, -30], [30, -30], [30, 30], [0, 30]]]},
      {"position_mm": 30, "polygons_mm": [[[0, -30], [30, -30], [30, 30], [0, 30]]]}]})";
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "side", "do": "mask", "slices": "slices.json"},
      {"id": "half", "do": "combine", "expression": "ball & side"})"));
  const Object& half = evaluation.object("half");
  EXPECT_NEAR(half.voxel.measures.volume_mm3 / ball_mm3(ball_radius_mm), 0.5, 0.02);
  EXPECT_FALSE(half.mesh.whole);
  EXPECT_NE(evaluation.object("side").findings.at(0).find("between slices"), std::string::npos);
}

TEST(MaskStep, AMaskOfNothingIsRefused) {
  const TestFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "mask"})").find("'regions' is missing"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
