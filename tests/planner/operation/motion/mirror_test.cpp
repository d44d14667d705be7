// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(MirrorStep, AnImageLiesBehindThePlaneAndItsImageIsTheObject) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "twin", "do": "mirror", "object": "cap", "point_mm": [0, 0, 1], "normal": [0, 0, 2]},
      {"id": "back", "do": "mirror", "object": "twin", "point_mm": [0, 0, 1], "normal": [0, 0, 1]})"));
  const double cap = cap_mm3(ball_radius_mm, 5.0);
  expect_certified(evaluation.object("twin"), cap, 0.05);
  const glm::dvec3 before = *evaluation.object("cap").mesh.within->measures().centroid_mm;
  const glm::dvec3 after = *evaluation.object("twin").mesh.within->measures().centroid_mm;
  EXPECT_NEAR(after.z, 2.0 - before.z, 1e-9);
  EXPECT_NEAR(evaluation.object("twin").voxel.measures.centroid_mm->z, after.z, 0.5);
  EXPECT_TRUE(evaluation.object("back").voxel.octree == evaluation.object("cap").voxel.octree);
  EXPECT_GT(evaluation.object("twin").mesh.within->measures().volume_mm3, 0.0) << "the image is inside out";
}

TEST(MirrorStep, AnImageAboutAnotherPlaneAPartLostASurfacePushedOutAndNothingFail) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "twin", "do": "mirror", "object": "cap", "point_mm": [0, 0, 1], "normal": [0.1, 0, 1]},
      {"id": "other_plane", "do": "mirror", "object": "cap", "point_mm": [0, 0, 1], "normal": [0.2, 0, 1]},
      {"id": "plane_off", "do": "mirror", "object": "cap", "point_mm": [0, 0, 1.5], "normal": [0.1, 0, 1]},
      {"id": "half", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, -30], [8, -30], [8, 30], [-30, 30]]]}]},
      {"id": "part_lost", "do": "combine", "expression": "twin & half"},
      {"id": "wider", "do": "offset", "object": "twin", "by_mm": 1})"));
  EXPECT_EQ(verify::to_string(evaluation.object("twin").certificate->verdict), "PASS")
      << testing::PrintToString(evaluation.object("twin").certificate->reasons);
  for (const char* by : {"cap", "other_plane", "plane_off", "part_lost", "wider", ""})
    expect_fails_as(evaluation, "twin", by);
}

TEST(MirrorStep, ANormalWithoutLengthIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "mirror", "object": "ball", "normal": [0, 0, 0]})")
                .find("no direction"),
            std::string::npos);
}

TEST(MirrorStep, ThePlaneThatFitsIsSettledForBothKernels) {
  const ScratchFolder folder;
  // A lens that leans: its mid-planes all hold the direction (1, 0, 1) or are square to it.
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "off", "do": "move", "object": "ball", "translate_mm": [12, 0, 12]},
      {"id": "lens", "do": "combine", "expression": "ball & off"},
      {"id": "twin", "do": "mirror", "object": "lens", "fit": true, "overlap": 0.9})"));
  const Object &lens = evaluation.object("lens"), &twin = evaluation.object("twin");
  expect_certified(twin, lens.mesh.within->measures().volume_mm3, 0.02);
  EXPECT_LT(twin.mesh.details["rms_mm"].get<double>(), 0.1);
  EXPECT_LT(
      glm::distance(*twin.mesh.within->measures().centroid_mm, *lens.mesh.within->measures().centroid_mm),
      0.1);
  EXPECT_LT(glm::distance(*twin.voxel.measures.centroid_mm, *lens.voxel.measures.centroid_mm), 0.2);
}

TEST(MirrorStep, ThePlaneGoesThroughThreeLandmarks) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "marks", "do": "landmarks", "points": [{"name": "front", "point_mm": [3, -9, 0]}]},
      {"id": "off", "do": "move", "object": "ball", "translate_mm": [5, 0, 0]},
      {"id": "twin", "do": "mirror", "object": "off", "through": ["front", [3, 9, 0], [3, 0, 8]]})"));
  EXPECT_NEAR(evaluation.object("twin").mesh.within->measures().centroid_mm->x, 1.0, 0.05);
  EXPECT_NEAR(evaluation.object("twin").voxel.measures.centroid_mm->x, 1.0, 0.1);
  EXPECT_THROW(evaluate(ball_plan(folder, R"(
      {"id": "twin", "do": "mirror", "object": "ball", "through": [[0, 0, 0], [0, 5, 0], [0, 9, 0]]})")),
               std::runtime_error);
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "mirror", "object": "ball", "normal": [1, 0, 0],
      "through": [[0, 0, 0], [0, 5, 0], [0, 0, 9]]})")
                .find("states the plane a second time"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
