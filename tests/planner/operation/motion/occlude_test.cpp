// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

std::vector<double> distances_mm(const Evaluation& evaluation, const char* id) {
  return evaluation.object(id).moved->details.at("distances_at_places_mm").get<std::vector<double>>();
}

TEST(OccludeStep, ThreePlacesSeatATiltedCapFlat) {
  const ScratchFolder folder;
  // The lower cap's flat top, tilted and lowered, comes back to lie under the upper cap's flat base.
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "away", "do": "move", "object": "lower", "translate_mm": [0, 0, -4],
       "rotate": {"degrees": 5, "axis": [1, 2, 0], "about_mm": [0, 0, -5]}},
      {"id": "seated", "do": "occlude", "object": "away", "against": "upper", "about_mm": 4,
       "places": [[-12, -8, -9], [12, -8, -9], [0, 14, -9]]})")));
  for (const double distance : distances_mm(evaluation, "seated")) EXPECT_NEAR(distance, 0.0, 0.021);
  // Back by the same turn: the flat faces lie on each other, 10 mm above where the cap was.
  const glm::dmat4 motion = moved_since_made(evaluation.objects, "seated");
  EXPECT_LT(glm::distance(glm::dvec3(motion[2]), glm::dvec3(0, 0, 1)), 0.03);
  EXPECT_NEAR((motion * glm::dvec4(0, 0, -5, 1)).z, 5.0, 0.3);
  expect_certified(evaluation.object("seated"), cap_mm3(ball_radius_mm, 5.0), 0.08);
}

TEST(OccludeStep, OnePlaceSlidesAndStopsAGapBefore) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "near", "do": "occlude", "object": "lower", "against": "upper", "about_mm": 3, "gap_mm": 2,
       "places": [[0, 0, -5]]},
      {"id": "met", "do": "occlude", "object": "upper", "against": "lower", "towards": "down",
       "places": [[3, 0, 5]]})")));
  EXPECT_NEAR(evaluation.object("near").moved->motion[3].z, 8.0, 0.25);
  EXPECT_EQ(glm::dmat3(evaluation.object("near").moved->motion), glm::dmat3(1.0));
  EXPECT_NEAR(evaluation.object("met").moved->motion[3].z, -10.0, 0.25);
}

TEST(OccludeStep, TellsWhatItCannotSeatAndRefusesPlacesOffTheObject) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& fields) -> std::string {
    try {
      evaluate(
          ball_plan(folder, ball_caps(R"({"id": "a", "do": "occlude", "object": "lower", )" + fields + "}")));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(
      refusal(R"("against": "upper", "places": [[60, 0, 0]])").find("no surface within 3 mm of place 1"),
      std::string::npos);
  EXPECT_NE(
      refusal(R"("against": "upper", "places": [[0, 0, -5]], "towards": "down")").find("does not reach"),
      std::string::npos);
  EXPECT_NE(refusal(R"("against": "lower", "places": [[0, 0, -5]])").find("is the object itself"),
            std::string::npos);
  // A ball that is to touch at its side goes deeper at its top.
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "low_ball", "do": "move", "object": "ball", "translate_mm": [9, 0, -24]},
      {"id": "met", "do": "occlude", "object": "low_ball", "against": "upper",
       "places": [[-3, 0, -8]], "about_mm": 2})")));
  const std::vector<std::string>& findings = evaluation.object("met").findings;
  EXPECT_TRUE(std::any_of(
      findings.begin(), findings.end(),
      [](const std::string& finding) { return finding.find("away from the places") != std::string::npos; }))
      << testing::PrintToString(findings) << evaluation.object("met").moved->details;
}

}  // namespace
}  // namespace octotomy::planner
