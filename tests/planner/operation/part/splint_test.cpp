// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Splints between two caps of a ball, whose flat faces, 10 mm apart, stand for rows of teeth.
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/part/arch_band.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

const std::string arch_within = R"("arch": [[-10, 2, 5], [0, -8, 5], [10, 2, 5]])";
/// The arch lies beside the rim, where the ball narrows above its face.
const std::string arch_at_rim = R"("arch": [[-17, -6, 5], [0, -18, 5], [17, -6, 5]])";

std::string splint_step(const std::string& fields) {
  return ball_caps(R"({"id": "wafer", "do": "splint", "upper": "upper", "lower": "lower", )" + fields + "}");
}

/// The refusal of a plan with a splint, when it is read or evaluated.
std::string splint_refusal(const ScratchFolder& folder, const std::string& fields) {
  try {
    EvaluateOptions options;
    options.certify = false;
    evaluate(ball_plan(folder, splint_step(fields)), options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

void expect_refused_with(const std::string& refusal, const std::string& words) {
  EXPECT_NE(refusal.find(words), std::string::npos) << refusal;
}

double area_mm2(const std::vector<glm::dvec2>& outline_mm) {
  double doubled = 0.0;
  voxel::for_each_edge({outline_mm},
                       [&](const glm::dvec2& a, const glm::dvec2& b) { doubled += a.x * b.y - a.y * b.x; });
  return 0.5 * std::abs(doubled);
}

TEST(ArchBand, AStraightBandIsARectangleAndAnArchItsLengthTimesItsWidth) {
  const std::vector<glm::dvec2> line{{0, 0}, {10, 0}, {30, 0}};
  EXPECT_NEAR(area_mm2(band_outline(line, 8.0)), 30.0 * 8.0, 1e-6);
  std::vector<glm::dvec2> half_circle;
  for (int i = 0; i <= 8; ++i)
    half_circle.emplace_back(20.0 * std::cos(i * M_PI / 8.0), 20.0 * std::sin(i * M_PI / 8.0));
  // Pappus: the curve's length times the width.
  EXPECT_NEAR(area_mm2(band_outline(half_circle, 8.0)) / (M_PI * 20.0 * 8.0), 1.0, 0.01);
  EXPECT_NEAR(area_mm2(band_outline(longer_by(line, 3.0), 8.0)), 36.0 * 8.0, 1e-6);
}

TEST(ArchBand, InABendSharperThanHalfTheWidthTheInnerSideIsCutShort) {
  std::vector<glm::dvec2> bend;
  for (int i = 0; i <= 8; ++i)
    bend.emplace_back(3.0 * std::cos(i * M_PI / 8.0), 3.0 * std::sin(i * M_PI / 8.0));
  const std::vector<glm::dvec2> outline = band_outline(bend, 8.0);
  // Half a disc of 7 mm, which the square ends go beyond by what they reach past its middle.
  EXPECT_GT(area_mm2(outline), 0.5 * M_PI * 49.0 * 0.85);
  EXPECT_LT(area_mm2(outline), 0.5 * M_PI * 49.0 + 2.0 * 49.0);
}

TEST(ArchBand, ThePlaneLooksTowardsTheUpperJawWhicheverWayThePointsGo) {
  const std::vector<glm::dvec3> points{{-10, 2, 5}, {0, -8, 5}, {10, 2, 5}};
  const std::vector<glm::dvec3> back(points.rbegin(), points.rend());
  for (const auto& way : {points, back}) {
    const ArchFrame frame = arch_frame(way, {0, 0, 1});
    EXPECT_NEAR(frame.look.z, 1.0, 1e-12);
    EXPECT_NEAR(frame.height_mm, 5.0, 1e-12);
    EXPECT_NEAR(glm::distance(glm::cross(frame.look, frame.up), frame.right), 0.0, 1e-12);
  }
}

TEST(SplintStep, BetweenTwoFlatFacesIsTheBandTimesTheBiteLessTwoGaps) {
  const ScratchFolder folder;
  const Evaluation made = evaluate(ball_plan(folder, splint_step(arch_within + R"(, "width_mm": 8)")), {});
  const Object& wafer = made.objects.at("wafer");
  const ArchFrame frame = arch_frame({{-10, 2, 5}, {0, -8, 5}, {10, 2, 5}}, {0, 0, 1});
  const std::vector<glm::dvec2> outline = band_outline(frame.points_mm, 8.0);
  // Edges are rounded: along each, a quarter of a square of the radius less a quarter of a disc is cut off, and
  // the cuts stand off by a tenth of the radius.
  const double whole_mm3 = area_mm2(outline) * (10.0 - 0.2);
  ASSERT_TRUE(wafer.mesh.within);
  EXPECT_NEAR(wafer.mesh.within->size().volume_mm3 / whole_mm3, 1.0, 0.03);
  EXPECT_LT(wafer.mesh.within->size().volume_mm3, whole_mm3);
  EXPECT_NEAR(wafer.voxel.measures.volume_mm3 / whole_mm3, 1.0, 0.10);
  EXPECT_NEAR(wafer.mesh.within->size().high_mm.z, 4.9, 0.05);
  EXPECT_NEAR(wafer.mesh.within->size().low_mm.z, -4.9, 0.05);
  EXPECT_EQ(wafer.mesh.within->components().size(), 1u);
  ASSERT_TRUE(wafer.certificate);
  EXPECT_NE(verify::to_string(wafer.certificate->verdict), "FAIL")
      << testing::PrintToString(wafer.certificate->reasons);
}

TEST(SplintStep, AtARimThatIsUndercutItCanBePutOnBothJaws) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const Plan plan = ball_plan(folder, splint_step(arch_at_rim + R"(, "width_mm": 10)") + R"(,
      {"id": "up", "do": "seating", "object": "wafer", "against": ["upper"], "direction": [0, 0, 1]},
      {"id": "down", "do": "seating", "object": "wafer", "against": ["lower"], "direction": [0, 0, -1]})");
  const Json measured = measurements_json(plan, evaluate(plan, options));
  ASSERT_EQ(measured.size(), 2u);
  for (const Json& seat : measured) EXPECT_EQ(seat.at("verdict"), "PASS") << seat.dump(1);
}

TEST(SplintStep, RefusesWhatMakesNoSplintInASentenceThatSaysWhy) {
  const ScratchFolder folder;
  expect_refused_with(splint_refusal(folder, arch_within + R"(, "thickness_mm": 0.1)"), "thickness_mm");
  expect_refused_with(splint_refusal(folder, R"("arch": [[-10, 0, 5], [0, 0, 5], [10, 0, 5]])"),
                      "lie on one line");
  expect_refused_with(splint_refusal(folder, R"("arch": [[-10, 2, 5], [0, -8, 5], [10, 2, -5]])"),
                      "point 3 of the arch lies on 'lower', the others on 'upper'");
  expect_refused_with(splint_refusal(folder, R"("arch": [[-30, 2, 30], [0, -40, 30], [30, 2, 30]])"),
                      "mm off 'upper'");
  expect_refused_with(splint_refusal(folder, arch_within + R"(, "upper_direction": [1, 0, 0])"),
                      "so it runs along the teeth's sides");
  expect_refused_with(splint_refusal(folder, arch_within + R"(, "upper_direction": [0, 0, -1])"),
                      "180 degrees off the arch's normal");
}

}  // namespace
}  // namespace octotomy::planner
