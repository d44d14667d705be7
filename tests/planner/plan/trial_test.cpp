// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/trial.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;
/// A trial's errors: zero except for those that are named.
std::string errors_json(const std::string& named) {
  std::string text = named;
  for (const char* key : {"landmark_mm", "kerf_mm", "segmentation_mm", "seating_mm", "seating_deg"})
    if (named.find(key) == std::string::npos) text += ", \"" + std::string(key) + "\": 0";
  return text;
}

/// Two caps 10 mm apart, the lower one 4 mm upwards, and a distance and an angle of landmarks.
Json trials_of(const ScratchFolder& folder, const std::string& errors, const std::string& move) {
  const Plan plan = ball_plan(folder, ball_caps(R"({"id": "marks", "do": "landmarks", "points": [
      {"name": "a", "point_mm": [0, 0, -12]}, {"name": "b", "point_mm": [0, 0, -8]},
      {"name": "c", "point_mm": [12, 0, -8]}]},
      {"id": "up", "do": "move", "object": "lower", )" +
                                                move + R"(},
      {"id": "both", "do": "combine", "expression": "upper | up"},
      {"id": "length", "do": "measure", "points_mm": ["b", "c"]},
      {"id": "corner", "do": "measure", "points_mm": ["a@up", "b@up", "c@up"]},
      {"id": "doubt", "do": "trials", )" + errors_json(errors) +
                                                "}"));
  EvaluateOptions options;
  options.certify = false;
  return measurements_json(plan, evaluate(plan, options)).back();
}

Json doubt_of(const Json& trials, const std::string& what, const std::string& of) {
  for (const Json& doubt : trials.at("doubts"))
    if (doubt.at("what") == what && doubt.at("of") == of) return doubt;
  ADD_FAILURE() << what << " of " << of << " is not in " << trials.dump();
  return {{"value", 0.0}, {"half_width", 0.0}};
}
double width_of(const Json& trials, const std::string& what, const std::string& of) {
  return doubt_of(trials, what, of).at("half_width");
}

/// The half-width of 99 % of a normal distribution.
constexpr double normal_99 = 2.5758;
const std::string typed = R"("translate_mm": [0, 0, 4])";

TEST(TrialsStep, SeatingReachesDisplacementsAndGapsAsTheNormalLawSays) {
  const ScratchFolder folder;
  const Json trials = trials_of(folder, R"("seating_mm": 0.5)", typed);
  for (const char* word : {"forward", "left", "up"})
    EXPECT_NEAR(width_of(trials, word, "up, its centroid"), 0.5 * normal_99, 0.05) << word;
  EXPECT_NEAR(doubt_of(trials, "up", "up, its centroid").at("value").get<double>(), 4.0, 1e-9);
  // Two parallel faces: the gap is off by the part upwards.
  EXPECT_NEAR(doubt_of(trials, "gap", "upper and up").at("value").get<double>(), 6.0, 0.2);
  EXPECT_NEAR(width_of(trials, "gap", "upper and up"), 0.5 * normal_99, 0.05);
  EXPECT_EQ(width_of(trials, "overlap", "upper and up"), 0.0);
  EXPECT_EQ(width_of(trials, "distance", "length"), 0.0);
  EXPECT_EQ(doubt_of(trials, "gap", "upper and up").at("sources").size(), 1u);
}

TEST(TrialsStep, SegmentationClosesAGapFromBothSides) {
  const ScratchFolder folder;
  const Json trials = trials_of(folder, R"("segmentation_mm": 0.2)", typed);
  EXPECT_NEAR(width_of(trials, "gap", "upper and up"), 2.0 * 0.2 * normal_99, 0.04);
  EXPECT_EQ(width_of(trials, "up", "up, its centroid"), 0.0);
}

TEST(TrialsStep, LandmarksReachThroughTheMotionsMadeOfThem) {
  const ScratchFolder folder;
  const std::string by_marks = R"("from": "a", "to": "b")";
  const Json trials = trials_of(folder, R"("landmark_mm": 1)", by_marks);
  // The difference of two landmarks.
  EXPECT_NEAR(width_of(trials, "left", "up, its centroid"), std::sqrt(2.0) * normal_99, 0.15);
  EXPECT_NEAR(width_of(trials, "gap", "upper and up"), std::sqrt(2.0) * normal_99, 0.15);
  // A typed motion does not depend on them, but a distance and an angle of theirs do.
  const Json still = trials_of(folder, R"("landmark_mm": 1)", typed);
  EXPECT_EQ(width_of(still, "gap", "upper and up"), 0.0);
  EXPECT_NEAR(width_of(still, "distance", "length"), std::sqrt(2.0) * normal_99, 0.15);
  EXPECT_NEAR(doubt_of(still, "angle", "corner").at("value").get<double>(), 90.0, 1e-9);
  EXPECT_GT(width_of(still, "angle", "corner"), 20.0);
}

TEST(TrialsStep, OverlapGrowsWithDepthTimesArea) {
  const ScratchFolder folder;
  // The caps' faces overlap by 2 mm over the disc of radius sqrt(375).
  const Json trials = trials_of(folder, R"("seating_mm": 0.2)", R"("translate_mm": [0, 0, 12])");
  const double disc_mm2 = M_PI * 375.0;
  EXPECT_NEAR(doubt_of(trials, "overlap", "upper and up").at("value").get<double>() / (2.0 * disc_mm2), 1.0,
              0.1);
  EXPECT_NEAR(width_of(trials, "overlap", "upper and up") / (0.2 * normal_99 * disc_mm2), 1.0, 0.15);
}

TEST(TrialsStep, ASawsWidthWidensTheGapItMade) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "cut", "do": "saw", "object": "ball",
      "line_mm": [[-30, -30, 0], [30, -30, 0]], "direction": [0, 1, 0], "depth_mm": 60, "kerf_mm": 2},
      {"id": "high", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 0], [30, 0], [30, 30], [-30, 30]]]}]},
      {"id": "upper", "do": "combine", "expression": "cut & high"},
      {"id": "lower", "do": "combine", "expression": "cut - high"},
      {"id": "width", "do": "measure", "object": "upper", "to": "lower"},
      {"id": "doubt", "do": "trials", "kerf_mm": 0.1, "segmentation_mm": 0,
       "seating_mm": 0, "seating_deg": 0})");
  const Json trials = measurements_json(plan, evaluate(plan)).back();
  EXPECT_NEAR(doubt_of(trials, "gap", "upper and lower").at("value").get<double>(), 2.0, 0.3);
  EXPECT_NEAR(width_of(trials, "gap", "upper and lower"), 0.1 * normal_99, 0.02);
}

TEST(TrialsStep, SameSeedSameBits) {
  const ScratchFolder folder;
  const std::string errors =
      R"("seating_mm": 0.5, "seating_deg": 1, "landmark_mm": 1, "trials": 500, "seed": )";
  const std::string move = R"("from": "a", "to": "b")";
  EXPECT_EQ(trials_of(folder, errors + "7", move), trials_of(folder, errors + "7", move));
  EXPECT_NE(trials_of(folder, errors + "7", move), trials_of(folder, errors + "8", move));
}

}  // namespace
}  // namespace octotomy::planner
