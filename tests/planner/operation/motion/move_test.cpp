// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/anatomy/movement.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

constexpr const char* marks = R"({"id": "marks", "do": "landmarks", "points": [
    {"name": "front", "point_mm": [0, -20, 0]}, {"name": "rear", "point_mm": [0, 20, 0]},
    {"name": "left", "point_mm": [20, 0, 0]}, {"name": "core", "point_mm": [0, 4, 0]}, {"name": "far",
          "point_mm": [0, -26, 0]}]}, )";

class MoveStep : public testing::Test {
 protected:
  Evaluation moved(const std::string& move) const { return evaluate(ball_plan(folder_, marks + move)); }
  std::string refusal(const std::string& move) const { return ball_refusal(folder_, marks + move); }
  /// The position to which the last object's motion moves a point of the ball.
  static glm::dvec3 comes(const Evaluation& evaluation, const glm::dvec3& p_mm) {
    return glm::dvec3(evaluation.objects.back().moved->motion * glm::dvec4(p_mm, 1.0));
  }
  ScratchFolder folder_;
};

void expect_at(const glm::dvec3& p, const glm::dvec3& wanted) {
  EXPECT_LT(glm::distance(p, wanted), 1e-9) << p.x << " " << p.y << " " << p.z;
}

TEST_F(MoveStep, WordsOfTheHeadMoveAndTurnAboutALandmarkInBothKernels) {
  const Evaluation evaluation = moved(R"({"id": "m", "do": "move", "object": "ball",
      "by": {"forward_mm": 6, "up_mm": -2, "left_mm": 0.5}, "turn": {"pitch_deg": 90, "about_mm": "core"}})");
  expect_at(comes(evaluation, {0, 4, 0}), {0.5, -2, -2});    // the pivot moves by the translation alone
  expect_at(comes(evaluation, {0, -20, 0}), {0.5, -2, 22});  // the front goes up
  expect_certified(evaluation.object("m"), ball_mm3(ball_radius_mm), 0.02);
}

TEST_F(MoveStep, ForwardAlongAPlaneThatRisesToTheFrontRisesToo) {
  // An occlusal plane whose front is 3 higher over 4 of depth.
  const Evaluation evaluation = moved(R"({"id": "m", "do": "move", "object": "ball", "by": {"forward_mm": 10},
      "along": [[0, -4, 3], [-5, 0, 0], [5, 0, 0]]})");
  expect_at(comes(evaluation, {0, 0, 0}), {0, -8, 6});
}

TEST_F(MoveStep, MarksGoFromOneToAnotherAndToATypedPoint) {
  expect_at(
      comes(moved(R"({"id": "m", "do": "move", "object": "ball", "from": "front", "to": "far"})"), {0, 0, 0}),
      {0, -6, 0});
  expect_at(comes(moved(R"({"id": "m", "do": "move", "object": "ball", "from": "left", "to": [22, 1, 0]})"),
                  {0, 0, 0}),
            {2, 1, 0});
}

TEST_F(MoveStep, PointsTellHowFarEachComesFromWhereItIsWanted) {
  const Evaluation evaluation = moved(R"({"id": "m", "do": "move", "object": "ball", "fit": "first_point",
      "points": [{"at": "front", "up_mm": 7, "left_mm": 2}, {"at": "rear", "up_mm": 3, "left_mm": 2}]})");
  const auto all = movements_json(evaluation.objects, {{"front", {0, -20, 0}}, {"out", {0, 0, 60}}});
  ASSERT_EQ(all.size(), 1u);
  const auto& points = all[0].at("points");
  EXPECT_LT(points[0].at("residual_mm").get<double>(), 1e-9);
  EXPECT_NEAR(points[1].at("residual_mm").get<double>(), std::hypot(40.0, 4.0) - 40.0, 1e-9);
  EXPECT_EQ(points[0].at("achieved"), "up 7.0 mm, left 2.0 mm");
  EXPECT_EQ(points[1].at("wanted"), "up 3.0 mm, left 2.0 mm");
  ASSERT_EQ(all[0].at("landmarks").size(), 1u) << "only the landmark on the ball is told";
  EXPECT_EQ(all[0].at("landmarks")[0].at("words"), "up 7.0 mm, left 2.0 mm");
  EXPECT_NEAR(all[0].at("pitch_deg").get<double>(), glm::degrees(std::atan2(4.0, 40.0)), 1e-9);
}

TEST_F(MoveStep, AnotherPieceGoesAlongAndALandmarkGoesWithItsPiece) {
  const Evaluation evaluation = moved(R"(
      {"id": "a", "do": "move", "object": "ball", "by": {"forward_mm": 5}},
      {"id": "b", "do": "move", "object": "a", "with": "a"},
      {"id": "c", "do": "move", "object": "ball", "from": "front", "to": "front@b"},
      {"id": "d", "do": "move", "object": "ball", "matrix": [[1,0,0,0],[0,1,0,-10],[0,0,1,0],[0,0,0,1]]})");
  EXPECT_TRUE(evaluation.object("c").voxel.octree == evaluation.object("b").voxel.octree);
  EXPECT_TRUE(evaluation.object("d").voxel.octree == evaluation.object("b").voxel.octree);
  EXPECT_NEAR(evaluation.object("b").voxel.measures.centroid_mm->y, -10.0, 0.05);
  const auto all = movements_json(evaluation.objects, {{"front", {0, -20, 0}}});
  EXPECT_EQ(all[1].at("landmarks")[0].at("words"), "forward 5.0 mm");
  EXPECT_EQ(all[1].at("landmarks")[0].at("since_scan").at("words"), "forward 10.0 mm");
}

TEST_F(MoveStep, AnAxisThroughTwoMarksTurnsAboutThem) {
  const Evaluation evaluation = moved(R"({"id": "m", "do": "move", "object": "ball",
      "rotate": {"degrees": 90, "through": ["rear", "front"]}})");
  expect_at(comes(evaluation, {0, -20, 0}), {0, -20, 0});
  expect_at(comes(evaluation, {20, 0, 0}), {0, 0, 20});
}

TEST_F(MoveStep, RefusalsPointAtThePlace) {
  const auto says = [&](const std::string& fields, const std::string& part) {
    const std::string text = refusal(R"({"id": "m", "do": "move", "object": "ball")" + fields + "}");
    EXPECT_NE(text.find(part), std::string::npos) << fields << " says: " << text;
    EXPECT_NE(text.find("step 'm'"), std::string::npos) << text;
  };
  says("", "moves nothing");
  says(R"(, "from": "front")", "'to' is missing");
  says(R"(, "from": "front", "to": "reer")", "to: no landmark is called 'reer', did you mean 'rear'?");
  says(R"(, "from": "front@none", "to": "rear")", "no earlier step is called 'none'");
  says(R"(, "by": {"forward_mm": 1}, "along": ["front", "rear", [0, 0, 0]])", "on one line");
  says(R"(, "translate_mm": [1, 0, 0], "along": ["front", "rear", "left"])", "add 'by'");
  says(R"(, "with": "ball")", "with: 'ball' was made by 'window'");
  says(R"(, "with": "ball", "translate_mm": [1, 0, 0])", "states its motion twice: keep only");
  says(R"(, "rotate": {"degrees": 3})", "rotate: 'axis' is missing");
  says(R"(, "rotate": {"degrees": 3, "axis": [1, 0, 0]}, "turn": {"about_mm": "rear"})", "twice");
  says(R"(, "points": [{"at": "front", "up_mm": 1}, {"at": "front", "up_mm": 1}])",
       "points: 'front' and 'front'");
  says(R"(, "points": [{"at": "front", "up_mm": 1, "to": "rear"}])", "points[0]: ");
  says(R"(, "matrix": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])", "matrix: is not a rigid motion");
  says(R"(, "matrix": [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])", "matrix: is not a rigid motion");
}

}  // namespace
}  // namespace octotomy::planner
