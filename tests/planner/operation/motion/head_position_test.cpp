// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/operation/anatomy/head_directions.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

glm::dmat3 held(const std::string& fields) {
  const ScratchFolder folder;
  return *ball_plan(folder, R"({"id": "held", "do": "head_position", )" + fields + "}").lps_from_head;
}

void expect_frame(const glm::dmat3& frame, const glm::dmat3& wanted) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(glm::distance(frame[axis], wanted[axis]), 1e-9) << axis;
}

TEST(HeadPositionStep, TheFrankfortPlaneIsHeldLevelAndTheMidPlaneUpright) {
  // A head turned by 20 degrees of pitch, 8 of yaw and -5 of roll in the scanner, with its marks.
  const glm::dmat3 lies = rotation_of({20, 8, -5}, glm::dmat3(1.0));
  const auto at = [&](const glm::dvec3& p) {
    const glm::dvec3 q = lies * p;
    return "[" + std::to_string(q.x) + "," + std::to_string(q.y) + "," + std::to_string(q.z) + "]";
  };
  const std::string marks = R"("frankfort": [)" + at({-60, 0, 0}) + "," + at({60, 0, 0}) + "," +
                            at({-30, -80, 0}) + "," + at({30, -80, 0}) + "]";
  const auto near = [](const glm::dmat3& a, const glm::dmat3& b) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_LT(glm::distance(a[axis], b[axis]), 1e-6) << axis;
  };
  near(held(marks), lies);
  // Porions of unequal depth turn the frame; the mid-plane sets it right.
  const std::string skew = R"("frankfort": [)" + at({-60, 5, 0}) + "," + at({60, -5, 0}) + "," +
                           at({-30, -80, 0}) + "," + at({30, -80, 0}) + R"(], "midline": [)" +
                           at({0, -90, 30}) + "," + at({0, 20, -25}) + "]";
  near(held(skew), lies);
}

TEST(HeadPositionStep, TypedAnglesSayHowTheHeadIsHeldInTheRoom) {
  // Held with the front 10 degrees higher: what is level in the scan then rises to the front.
  const glm::dmat3 frame = held(R"("pitch_deg": 10)");
  const Displacement forward = displacement_of({0, -10, 0}, frame);
  EXPECT_NEAR(forward.up_mm, 10.0 * std::sin(glm::radians(10.0)), 1e-9);
  EXPECT_GT(forward.forward_mm, 9.0);
  expect_frame(held(R"("yaw_deg": 0)"), glm::dmat3(1.0));
}

TEST(HeadPositionStep, RegionsAndWordsAreOfTheHeadAsItIsHeld) {
  const ScratchFolder folder;
  // Held upside down, the upper half of the anterior view is the lower half of the scan.
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "held", "do": "head_position", "roll_deg": 180},
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "up", "do": "move", "object": "cap", "by": {"up_mm": 4}})"));
  EXPECT_LT(evaluation.object("cap").voxel.measures.centroid_mm->z, -5.0);
  expect_certified(evaluation.object("cap"), cap_mm3(ball_radius_mm, 5.0), 0.05);
  EXPECT_NEAR(evaluation.object("up").moved->motion[3].z, -4.0, 1e-9);
  // Views of the scan do not turn with the head.
  const Evaluation as_it_lies = evaluate(ball_plan(folder, R"(
      {"id": "held", "do": "head_position", "roll_deg": 180},
      {"id": "cut", "do": "mask", "views_of": "scan", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"})"));
  EXPECT_GT(as_it_lies.object("cap").voxel.measures.centroid_mm->z, 5.0);
  expect_certified(as_it_lies.object("cap"), cap_mm3(ball_radius_mm, 5.0), 0.05);
  // An oblique cut in a head held askew is certified, too.
  const Evaluation askew = evaluate(ball_plan(folder, R"(
      {"id": "held", "do": "head_position", "roll_deg": 12, "pitch_deg": -7, "yaw_deg": 3},
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"})"));
  expect_certified(askew.object("cap"), cap_mm3(ball_radius_mm, 5.0), 0.03);
}

TEST(HeadPositionStep, RefusalsPointAtThePlace) {
  const ScratchFolder folder;
  const auto says = [&](const std::string& fields, const std::string& part) {
    const std::string text = ball_refusal(folder, R"({"id": "h", "do": "head_position", )" + fields);
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  says(R"("frankfort": [[60, 0, 0], [-60, 0, 0], [30, -80, 0]]})",
       "frankfort: the second point lies to the patient's right");
  says(R"("frankfort": [[-60, 0, 0], [60, 0, 0], [30, -3, 0]]})", "one line");
  says(R"("frankfort": [[-60, 0, 0], [60, 0, 0]]})", "at least 3");
  says(R"("midline": [[0, 0, 0], [0, 1, 50]]})", "midline:");
  says(R"("pitch_deg": 1}, {"id": "again", "do": "head_position", "pitch_deg": 2})", "keep one of the two");
}

}  // namespace
}  // namespace octotomy::planner
