// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/anatomy/movement.h"
#include "planner/operation/measure/measured_ratios.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// Landmarks of skin and bone on a ball about the origin, whose front is the skin, and a cap that is the bone.
const std::string marks = R"({"id": "marks", "do": "landmarks", "points": [
      {"name": "incisor", "point_mm": [0, 0, 8]}, {"name": "upper_lip", "point_mm": [0, -20, 0]},
      {"name": "chin", "point_mm": [0, -16, -12]}]},
      {"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "upper", "do": "combine", "expression": "ball & high"},
      {"id": "advanced", "do": "move", "object": "upper", "translate_mm": [0, -4, 1]})";
const std::string by_ratio = R"(, {"id": "face", "do": "landmark_ratios", "object": "ball", "fade_mm": 25,
      "pairs": [{"soft": "upper_lip", "bone": "incisor@advanced"}, {"soft": "chin"}]})";

MeasuredRatios measured_of(const Object& object) {
  return record_of<MeasuredRatios>(object.mesh.details);
}

TEST(LandmarkRatios, LandmarksMoveByThePublishedRatioAndOthersStay) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, marks + by_ratio);
  const Evaluation evaluation = evaluate(plan);
  const Object& face = evaluation.object("face");
  ASSERT_TRUE(face.certificate);
  EXPECT_EQ(verify::to_string(face.certificate->verdict), "PASS")
      << testing::PrintToString(face.certificate->reasons);
  EXPECT_TRUE(face.certificate->independent());
  const MeasuredRatios found = measured_of(face);
  ASSERT_EQ(found.landmarks.size(), 2u);
  const RatioLandmark& lip = found.landmarks[0];
  EXPECT_EQ(lip.follows, "incisor@advanced");
  EXPECT_EQ(lip.source, "Freihofer 1976");
  EXPECT_LT(glm::distance(lip.moved_mm, glm::dvec3(0, -0.56 * 4, 0.56)), 1e-12);
  EXPECT_NEAR(*lip.half_width_mm, 2.5758 * 0.2 * std::sqrt(17.0), 1e-9);
  EXPECT_EQ(found.landmarks[1].moved_mm, glm::dvec3(0.0));
  // The surface goes where the landmark goes: forward by 2.24 mm in both kernels.
  EXPECT_NEAR(face.mesh.within->size().low_mm.y, -22.24, 0.15);
  EXPECT_NEAR(face.voxel.measures.extents->low_mm.y, -22.24, 1.0);
  // Beyond the reach nothing moves: the back of the ball keeps all of its points.
  const brep::Triangles &before = evaluation.object("ball").mesh.whole->triangles(),
                        &after = face.mesh.whole->triangles();
  int at_rest = 0;
  for (std::size_t i = 0; i < before.points_mm.size(); ++i)
    if (glm::distance(before.points_mm[i], {0, -20, 0}) > 25.0 &&
        glm::distance(before.points_mm[i], {0, -16, -12}) > 25.0) {
      ++at_rest;
      EXPECT_EQ(before.points_mm[i], after.points_mm[i]);
    }
  EXPECT_GT(at_rest, 1000);
}

TEST(LandmarkRatios, APublishedRatioOfABoneThatGoesBackIsAFinding) {
  for (const auto& [translate, is_setback] :
       {std::pair("[0, -4, 1]", false), std::pair("[0, 4, 1]", true), std::pair("[4, -1, 0]", true)}) {
    const ScratchFolder folder;
    std::string steps = marks + by_ratio;
    steps.replace(steps.find("[0, -4, 1]"), 10, translate);
    const Evaluation evaluation = evaluate(ball_plan(folder, steps));
    const std::string findings = testing::PrintToString(evaluation.object("face").findings);
    EXPECT_EQ(findings.find("that advance the bone") != std::string::npos, is_setback) << findings;
    EXPECT_NE(findings.find("deviations are estimates"), std::string::npos) << findings;
  }
}

TEST(LandmarkRatios, RatiosUpwardsAndDeviationsAreThoseTyped) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, marks + R"(, {"id": "face", "do": "landmark_ratios",
      "object": "ball", "pairs": [{"soft": [0, -20, 0], "bone": "incisor@advanced", "ratio": 0.5, "ratio_up": 0.2,
      "deviation": 0.1}, {"soft": "chin", "bone": "incisor@advanced", "ratio": 0.1}]})"));
  const MeasuredRatios found = measured_of(evaluation.object("face"));
  EXPECT_LT(glm::distance(found.landmarks[0].moved_mm, glm::dvec3(0, -2, 0.2)), 1e-12);
  EXPECT_NEAR(*found.landmarks[0].half_width_mm, 0.25758 * std::sqrt(17.0), 1e-9);
  EXPECT_FALSE(found.landmarks[1].half_width_mm);
  const std::string findings = testing::PrintToString(evaluation.object("face").findings);
  EXPECT_NE(findings.find("no interval for 'chin'"), std::string::npos) << findings;
}

TEST(LandmarkRatios, AnotherAnswerFailsInEitherKernel) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"({"id": "marks", "do": "landmarks", "points": [
      {"name": "incisor", "point_mm": [0, 0, 8]}, {"name": "upper_lip", "point_mm": [0, -10, 0]}]},
      {"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "upper", "do": "combine", "expression": "ball & high"},
      {"id": "advanced", "do": "move", "object": "upper", "translate_mm": [0, -4, 1]},
      {"id": "face", "do": "landmark_ratios", "object": "ball", "fade_mm": 18,
        "pairs": [{"soft": "upper_lip", "bone": "incisor@advanced"}]},
      {"id": "more", "do": "landmark_ratios", "object": "ball", "fade_mm": 18,
        "pairs": [{"soft": "upper_lip", "bone": "incisor@advanced", "ratio": 0.8}]})",
                                                   small_radius_mm));
  for (const char* by : {"ball", "more", ""}) expect_fails_as(evaluation, "face", by);
  expect_fails_as(evaluation, "face", pushed_out(evaluation, "face", 1.0), "pushed out");
}

TEST(LandmarkRatios, ALaterCephalometryReadsTheSkinWhereTheRatiosPutIt) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, marks + by_ratio);
  EvaluateOptions options;
  options.certify = false;
  const Evaluation evaluation = evaluate(plan, options);
  for (const MovedLandmark& each : moved_landmarks(evaluation.objects, plan.landmarks)) {
    const glm::dvec3 by = carried(each.moved_from_still, each.landmark.p_mm) - each.landmark.p_mm;
    EXPECT_EQ(each.is_predicted, each.landmark.name != "incisor") << each.landmark.name;
    const glm::dvec3 expected = each.landmark.name == "incisor"     ? glm::dvec3(0, -4, 1)
                                : each.landmark.name == "upper_lip" ? glm::dvec3(0, -2.24, 0.56)
                                                                    : glm::dvec3(0.0);
    EXPECT_LT(glm::distance(by, expected), 1e-12) << each.landmark.name;
  }
}

TEST(LandmarkRatios, TwoPredictionsOfOneSkinAreComparedPointByPoint) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, marks + by_ratio + R"(,
      {"id": "more", "do": "landmark_ratios", "object": "ball", "fade_mm": 25,
        "pairs": [{"soft": "upper_lip", "bone": "incisor@advanced", "ratio": 1}, {"soft": "chin"}]},
      {"id": "apart", "do": "compare", "a": "face", "b": "more"},
      {"id": "none", "do": "compare", "a": "face", "b": "ball", "no_dice": true},
      {"id": "not_predicted", "do": "compare", "a": "ball", "b": "upper"})");
  const Json all = measurements_json(plan, evaluate(plan));
  ASSERT_TRUE(all[0].contains("face")) << all[0];
  const Json& face = all[0]["face"];
  EXPECT_EQ(face["skin"], "ball");
  // The fields are proportional, so that the largest difference is that of the lip.
  EXPECT_NEAR(face["largest_mm"].get<double>(), 0.44 * std::sqrt(17.0), 0.02);
  EXPECT_GT(face["mean_mm"].get<double>(), 0.1);
  EXPECT_LT(face["mean_mm"].get<double>(), face["largest_mm"].get<double>());
  EXPECT_NEAR(face["landmarks"][0]["difference_mm"].get<double>(), 0.44 * std::sqrt(17.0), 0.02);
  EXPECT_NEAR(face["landmarks"][1]["difference_mm"].get<double>(), 0.0, 0.02);
  // The still skin itself is a prediction of no motion.
  EXPECT_NEAR(all[1]["face"]["largest_mm"].get<double>(), 0.56 * std::sqrt(17.0), 0.02);
  EXPECT_FALSE(all[2].contains("face"));
}

void write_landmarks(const std::filesystem::path& path, double forward_mm, double lip_mm) {
  std::ofstream(path) << R"({"landmarks": [{"name": "incisor", "point_mm": [0, )" << -forward_mm
                      << R"(, 8]}, {"name": "upper_lip", "point_mm": [0, )" << -lip_mm << ", 0]}]}";
}

TEST(LandmarkRatios, FilesOfLandmarksBeforeAndAfterTakeThePlaceOfPairs) {
  const ScratchFolder folder;
  write_landmarks(folder / "before.json", 0.0, 20.0);
  write_landmarks(folder / "after.json", 5.0, 20.0);
  EvaluateOptions options;
  options.certify = false;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "face", "do": "landmark_ratios", "object": "ball", "before": "before.json", "after": "after.json"},
      {"id": "typed", "do": "landmark_ratios", "object": "ball", "before": "before.json", "after": "after.json",
        "ratios": ["upper_lip:incisor:0.9"]})"),
                                         options);
  EXPECT_NEAR(measured_of(evaluation.object("face")).landmarks.at(0).moved_mm.y, -2.8, 1e-12);
  const MeasuredRatios typed = measured_of(evaluation.object("typed"));
  ASSERT_EQ(typed.landmarks.size(), 1u);
  EXPECT_NEAR(typed.landmarks[0].moved_mm.y, -4.5, 1e-12);
}

TEST(LandmarkRatios, WrongInputIsRefusedInOneLineEach) {
  const ScratchFolder folder;
  write_landmarks(folder / "before.json", 0.0, 20.0);
  std::ofstream(folder / "other.json") << R"({"landmarks": [{"name": "x", "point_mm": [0, 0, 0]}]})";
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"("fade_mm": 20)", "moves no landmark: add 'pairs'"},
      {R"("pairs": [{"soft": "upper_lip", "ratio": 0.5}])", "states a ratio without a landmark"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor"}])", "'incisor' has no motion: add the object"},
      {R"("pairs": [{"soft": "upper_lip", "bone": [0, 0, 8]}])", "is a typed point, which has no motion"},
      {R"("pairs": [{"soft": "chin", "bone": "incisor@advanced"}])",
       "no published ratio for 'chin' to 'incisor'"},
      {R"("pairs": [{"soft": "nose", "bone": "incisor@advanced"}])", "nose"},
      {R"("pairs": [{"soft": "upper_lip"}])", "move nothing, because no pair has a landmark of the bone"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@advanced", "ratio": -1}])", "ratio"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@advanced", "deviation": 0.1}])",
       "applies only to a typed ratio"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@advanced"}, {"soft": "upper_lip"}])",
       "occurs in an earlier pair, too"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@ball"}])",
       "there is no motion: 'incisor@ball' stays"},
      {R"("pairs": [{"soft": [0, -33, 0], "bone": "incisor@advanced", "ratio": 1}])",
       "13.0 mm from the surface of 'ball': place it on the skin"},
      {R"("fade_mm": 3, "pairs": [{"soft": "upper_lip", "bone": "incisor@advanced"}])", "state at least"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@advanced", "ratio": 2}, {"soft": [0, -20, 1]}])",
       "are 1.00 mm apart, and their displacements differ by 8.25 mm"},
      {R"("pairs": [{"soft": "upper_lip", "bone": "incisor@advanced"}], "ratios": ["a:b:1"])",
       "state 'ratio' in each pair"},
      {R"("before": "before.json")", "'after' is missing"},
      {R"("before": "before.json", "after": "before.json")", "there is no motion"},
      {R"("before": "before.json", "after": "other.json")", "no pair of landmarks with a ratio is in both"},
      {R"("before": "before.json", "after": "other.json", "ratios": ["upper_lip:incisor"])",
       "SOFT:BONE:RATIO"},
      {R"("before": "before.json", "after": "other.json", "ratios": ["upper_lip:incisor:0.5"])",
       "has no landmark 'incisor' for the ratio upper_lip:incisor"}};
  for (const auto& [fields, expected] : cases) {
    const std::string text = made_refusal(
        folder, marks + R"(, {"id": "face", "do": "landmark_ratios", "object": "ball", )" + fields + "}");
    EXPECT_NE(text.find(expected), std::string::npos) << fields << "\n" << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace octotomy::planner
