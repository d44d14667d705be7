// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/scene_pictures.h"

#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

const std::string first_jaw = R"(
    {"id": "high", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
    {"id": "cap", "do": "combine", "expression": "ball & high"}, {"id": "rest", "do": "combine",
          "expression": "ball - high"},
    {"id": "cap_moved", "do": "move", "object": "cap", "translate_mm": [0, -4, 0]},
    {"id": "one", "do": "combine", "expression": "rest | cap_moved"})";

std::string names(const std::vector<voxel::DrawnObject>& objects) {
  std::string text;
  for (const voxel::DrawnObject& object : objects) text += object.name + " ";
  return text;
}

FinalScene scene_of(const std::string& steps) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, steps);
  EvaluateOptions quick;
  quick.meshes = false;
  return final_scene(plan, evaluate(plan, quick));
}

TEST(ScenePictures, OneMoveShowsItsPiecesBeforeAndAfterInTheSameColours) {
  const FinalScene scene = scene_of(first_jaw);
  EXPECT_EQ(names(scene.before), "rest cap ");
  EXPECT_EQ(names(scene.after), "rest cap_moved ");
  EXPECT_EQ(scene.before[1].colour, scene.after[1].colour);
}

TEST(ScenePictures, BeforeATwoJawPlanIsTheUntouchedPatient) {
  const FinalScene scene = scene_of(first_jaw + R"(,
      {"id": "low", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, -5], [30, -5], [30, -30], [-30, -30]]]}]},
      {"id": "cup", "do": "combine", "expression": "one & low"}, {"id": "rest_2", "do": "combine",
          "expression": "one - low"},
      {"id": "cup_moved", "do": "move", "object": "cup", "translate_mm": [0, -3, 0]},
      {"id": "two", "do": "combine", "expression": "rest_2 | cup_moved"})");
  EXPECT_EQ(names(scene.before), "ball ");
  EXPECT_EQ(names(scene.after), "rest_2 cup_moved ");
  EXPECT_TRUE(scene.moves);
}

TEST(ScenePictures, BeforeAddedBoneIsThePatientWithoutIt) {
  const FinalScene scene = scene_of(first_jaw.substr(0, first_jaw.find("{\"id\": \"cap_moved\"")) + R"(
      {"id": "mirrored", "do": "mirror", "object": "cap", "normal": [0, 0, 1]},
      {"id": "filled", "do": "combine", "expression": "rest | mirrored"})");
  EXPECT_EQ(names(scene.before), "ball ");
  EXPECT_EQ(names(scene.after), "rest mirrored ");
  EXPECT_TRUE(scene.moves);
}

}  // namespace
}  // namespace octotomy::planner
