// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/flap/design.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace octotomy::planner {
namespace {

FlapPlan arch() {
  FlapPlan plan;
  plan.curve_mm = {{-40, -50, -85}, {-22, -78, -92}, {22, -78, -92}, {40, -50, -85}};
  plan.donor_from_mm = {30, 12, 100};
  plan.donor_to_mm = {34, 16, -120};
  plan.donor_face_mm = {45, 12, 100};
  return plan;
}

glm::dvec3 at(const glm::dmat4& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion * glm::dvec4(p_mm, 1.0));
}

std::string refusal(const FlapPlan& plan) {
  try {
    flap_segments(plan);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(FlapDesign, ALineAlongTheDonorContinuesAcrossEveryOsteotomy) {
  // Points of one line along the donor, taken to both sides of a joint, meet on its plane: equal
  // cross-sections match edge to edge.
  const FlapPlan plan = arch();
  const std::vector<FlapSegment> segments = flap_segments(plan);
  ASSERT_EQ(segments.size(), 3u);
  const glm::dvec3 axis = glm::normalize(plan.donor_to_mm - plan.donor_from_mm);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-12, 12);
  for (int line = 0; line < 100; ++line) {
    const glm::dvec3 through =
        plan.donor_from_mm + glm::dvec3(offset(random), offset(random), offset(random));
    const auto meets = [&](const FlapSegment& segment, const FlapPlane& cut) {
      const glm::dvec3 p = at(segment.placed_from_donor, through);
      return p +
             segment.along * (glm::dot(cut.normal, cut.point_mm - p) / glm::dot(cut.normal, segment.along));
    };
    EXPECT_NEAR(glm::length(glm::dmat3(segments[0].placed_from_donor) * axis - segments[0].along), 0, 1e-12);
    for (std::size_t i = 0; i + 1 < segments.size(); ++i)
      EXPECT_LT(glm::distance(meets(segments[i], segments[i].end), meets(segments[i + 1], segments[i].end)),
                1e-9)
          << "line " << line << ", joint " << i + 1;
  }
}

TEST(FlapDesign, ATwistedSegmentWouldNotMatch) {
  FlapPlan rolled = arch();
  rolled.roll_deg = 30;
  const FlapSegment still = flap_segments(arch())[0], next = flap_segments(rolled)[1];
  const glm::dvec3 off = arch().donor_from_mm + glm::dvec3(8, 0, 0);
  const auto meets = [&](const FlapSegment& segment) {
    const glm::dvec3 p = at(segment.placed_from_donor, off);
    return p + segment.along * (glm::dot(still.end.normal, still.end.point_mm - p) /
                                glm::dot(still.end.normal, segment.along));
  };
  EXPECT_GT(glm::distance(meets(still), meets(next)), 2.0);
}

TEST(FlapDesign, TheNarrowestPlaceBetweenSegmentsOnTheDonorLeavesRoomForTheSaw) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> by(-8, 8);
    FlapPlan plan = arch();
    plan.kerf_mm = 0.8;
    plan.reach_mm = 8;
    for (glm::dvec3& corner : plan.curve_mm) corner += glm::dvec3(by(random), by(random), by(random));
    const std::vector<FlapSegment> segments = flap_segments(plan);
    const glm::dvec3 axis = glm::normalize(plan.donor_to_mm - plan.donor_from_mm);
    for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
      const FlapPlane &end = segments[i].donor_end, &start = segments[i + 1].donor_start;
      double narrowest_mm = 1e9;
      for (int step = 0; step < 720; ++step) {
        const double angle = glm::radians(0.5 * step);
        const glm::dvec3 right = glm::normalize(glm::cross(axis, glm::dvec3(0, 1, 0)));
        const glm::dvec3 off = 8.0 * (std::cos(angle) * right + std::sin(angle) * glm::cross(axis, right));
        const auto reaches = [&](const FlapPlane& cut) {
          return glm::dot(axis, cut.point_mm) - glm::dot(off, cut.normal) / glm::dot(axis, cut.normal);
        };
        narrowest_mm = std::min(narrowest_mm, reaches(start) - reaches(end));
      }
      EXPECT_GE(narrowest_mm, plan.kerf_mm) << "replay: seed " << seed << ", joint " << i + 1;
      EXPECT_LT(narrowest_mm, plan.kerf_mm + 6) << "seed " << seed << ": bone is wasted";
    }
  }
}

TEST(FlapDesign, LengthsAnglesAndOrderAreThoseOfTheCurve) {
  const std::vector<FlapSegment> segments = flap_segments(arch());
  EXPECT_NEAR(segments[1].length_mm, 44.0, 1e-12);
  EXPECT_NEAR(segments[1].turn_deg, segments[2].turn_deg, 1e-9);
  EXPECT_NEAR(segments[1].start_tilt_deg, 0.5 * segments[1].turn_deg, 1e-9);
  EXPECT_NEAR(segments[0].start_tilt_deg, 0.0, 1e-6) << "without stumps the ends are square";
  EXPECT_EQ(segments[0].donor_start_mm, 0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(segments[i].donor_end_mm - segments[i].donor_start_mm, segments[i].length_mm, 1e-12);
    EXPECT_NEAR(glm::determinant(glm::dmat3(segments[i].placed_from_donor)), 1.0, 1e-12);
    if (i > 0) {
      EXPECT_GT(segments[i].donor_start_mm, segments[i - 1].donor_end_mm);
    }
  }
}

TEST(FlapDesign, RefusalsNameTheCornerOrSegment) {
  FlapPlan plan = arch();
  plan.curve_mm[1] = plan.curve_mm[2];
  EXPECT_NE(refusal(plan).find("corners 2 and 3"), std::string::npos) << refusal(plan);
  plan = arch();
  std::swap(plan.curve_mm[1], plan.curve_mm[3]);
  EXPECT_NE(refusal(plan).find("120°"), std::string::npos) << refusal(plan);
  plan = arch();
  plan.reach_mm = 60;
  EXPECT_NE(refusal(plan).find("cuts cross"), std::string::npos) << refusal(plan);
  plan = arch();
  plan.donor_to_mm = {32, 14, 20};
  EXPECT_NE(refusal(plan).find("mm more"), std::string::npos) << refusal(plan);
  plan = arch();
  plan.donor_face_mm = 0.5 * (plan.donor_from_mm + plan.donor_to_mm);
  EXPECT_NE(refusal(plan).find("lies on the donor's axis"), std::string::npos) << refusal(plan);
}

}  // namespace
}  // namespace octotomy::planner
