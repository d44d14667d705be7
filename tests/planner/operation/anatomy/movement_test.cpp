// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/anatomy/movement.h"

#include <gtest/gtest.h>

#include "planner/plan/evaluate.h"
#include "tests/planner/ball_scan.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

glm::dvec3 place(const std::vector<MovedLandmark>& landmarks, const std::string& name) {
  for (const MovedLandmark& each : landmarks)
    if (each.landmark.name == name)
      return glm::dvec3(each.moved_from_still * glm::dvec4(each.landmark.p_mm, 1.0));
  throw std::runtime_error(name);
}

TEST(MovedLandmarks, GoWithThePieceWhoseBoneIsNearestAlsoWhereTeethNearlyTouch) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 2.0;
  voxel::write_scene(verify::head_phantom(coarse), folder / "head.nrrd");
  // Neither skin nor bone of the operated scan is bone that stays.
  // The upper teeth end at -58 mm and the lower ones begin at -60 mm: landmarks of both are within reach.
  const Plan plan = parse_plan(R"json({"octotomy_plan": 1, "name": "two moves",
    "scans": {"ct": {"path": "head.nrrd"}}, "universe": {"voxel_mm": 1.0},
    "steps": [
      {"id": "marks", "do": "landmarks", "points": [
        {"name": "incisor", "point_mm": [0, -85, -57.5]}, {"name": "lower_incisor", "point_mm": [0, -84, -61]},
        {"name": "menton", "point_mm": [0, -82, -101]}, {"name": "nasion", "point_mm": [0, -84, 10]},
        {"name": "in_air", "point_mm": [0, -140, -57]}]},
      {"id": "skull", "do": "window", "scan": "ct", "low": 300},
      {"id": "cut", "do": "mask", "regions": [
        {"view": "anterior", "polygons_mm": [[[-40, -58.8], [40, -58.8], [40, -25], [-40, -25]]]},
        {"view": "left", "polygons_mm": [[[-120, -58.8], [-30, -58.8], [-30, -25], [-120, -25]]]}]},
      {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
      {"id": "rest", "do": "combine", "expression": "skull - cut"},
      {"id": "forward", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 0]},
      {"id": "down", "do": "move", "object": "forward", "translate_mm": [0, 0, -2]},
      {"id": "planned", "do": "combine", "expression": "rest | down"},
      {"id": "skin", "do": "window", "scan": "ct", "low": -300},
      {"id": "operated", "do": "scan_of", "scan": "ct", "expression": "planned | (skin - skull)"},
      {"id": "bone_again", "do": "window", "scan": "operated", "low": 300}]})json",
                               folder.path());
  EvaluateOptions quick;
  quick.meshes = quick.certify = false;
  const Evaluation evaluation = evaluate(plan, quick);
  const std::vector<MovedLandmark> landmarks = moved_landmarks(evaluation.objects, plan.landmarks);
  ASSERT_EQ(landmarks.size(), 5u);
  EXPECT_LT(glm::distance(place(landmarks, "incisor"), glm::dvec3(0, -91, -59.5)), 1e-9);
  EXPECT_LT(glm::distance(place(landmarks, "lower_incisor"), glm::dvec3(0, -84, -61)), 1e-9);
  EXPECT_LT(glm::distance(place(landmarks, "menton"), glm::dvec3(0, -82, -101)), 1e-9);
  EXPECT_LT(glm::distance(place(landmarks, "nasion"), glm::dvec3(0, -84, 10)), 1e-9);
  EXPECT_LT(glm::distance(place(landmarks, "in_air"), glm::dvec3(0, -140, -57)), 1e-9);
}

}  // namespace
}  // namespace octotomy::planner
