// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/anatomy/motion_of_points.h"

#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/anatomy/head_directions.h"

namespace octotomy::planner {
namespace {

glm::dvec3 moved(const PointMotion& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion.moved_from_still * glm::dvec4(p_mm, 1.0));
}

/// The thesis's case 3 (8.4.4, step F): the anterior maxilla goes up by 7 mm, the posterior by 3 mm, both
/// left by 2 mm.
std::vector<WantedPoint> case_3(double length_mm) {
  const glm::dvec3 anterior(0, -90, -30), posterior(0, -90 + length_mm, -30);
  return {{"anterior", anterior, anterior + glm::dvec3(2, 0, 7)},
          {"posterior", posterior, posterior + glm::dvec3(2, 0, 3)}};
}

TEST(MotionOfPoints, TwoPointsWithABiasedFirstBringThatOneHomeAndTheOtherAsFarAsARigidPieceLets) {
  constexpr double length_mm = 45.0;
  const std::vector<WantedPoint> wanted = case_3(length_mm);
  const PointMotion motion = motion_of_points(wanted, PointFit::FirstPoint);
  EXPECT_LT(motion.residuals_mm[0], 1e-12);
  // The second lies on the wanted line, at the old distance.
  const double stretched_mm = std::hypot(length_mm, 4.0);
  EXPECT_NEAR(motion.residuals_mm[1], stretched_mm - length_mm, 1e-9);
  const Displacement anterior =
      displacement_of(moved(motion, wanted[0].from_mm) - wanted[0].from_mm, glm::dmat3(1.0));
  const Displacement posterior =
      displacement_of(moved(motion, wanted[1].from_mm) - wanted[1].from_mm, glm::dmat3(1.0));
  EXPECT_EQ(in_words(anterior), "up 7.0 mm, left 2.0 mm");
  EXPECT_NEAR(posterior.up_mm, 7.0 - 4.0 * length_mm / stretched_mm, 1e-9);
  EXPECT_NEAR(posterior.left_mm, 2.0, 1e-9);
}

TEST(MotionOfPoints, TheThesissReportOfCaseThreeIsThisMotionInWholeVoxels) {
  // It reports (7.46, 2.13) and (3.2, 2.13) mm up and left, and blames the maxilla's rigidity. A rigid piece
  // whose first point is trusted moves that point as typed. All four numbers are 14, 4 and 6 voxels of
  // 8/15 mm, cut after two decimals: the movement rounded up to voxels.
  constexpr double voxel_mm = 8.0 / 15.0;
  const PointMotion motion = motion_of_points(case_3(45.0), PointFit::FirstPoint);
  const auto in_voxels = [](double mm) {
    return std::floor(100.0 * voxel_mm * std::ceil(mm / voxel_mm) + 0.01) / 100.0;
  };
  const glm::dvec3 anterior = moved(motion, {0, -90, -30}) - glm::dvec3(0, -90, -30);
  const glm::dvec3 posterior = moved(motion, {0, -45, -30}) - glm::dvec3(0, -45, -30);
  EXPECT_DOUBLE_EQ(in_voxels(anterior.z), 7.46);
  EXPECT_DOUBLE_EQ(in_voxels(anterior.x), 2.13);
  EXPECT_DOUBLE_EQ(in_voxels(posterior.z), 3.2);
  EXPECT_DOUBLE_EQ(in_voxels(posterior.x), 2.13);
  EXPECT_LT(std::abs(anterior.z - 7.46), voxel_mm);
  EXPECT_LT(std::abs(posterior.z - 3.2), voxel_mm);
}

TEST(MotionOfPoints, TheBestFitOfTwoPointsSharesWhatIsLeft) {
  const PointMotion motion = motion_of_points(case_3(45.0), PointFit::Best);
  const double half_mm = 0.5 * (std::hypot(45.0, 4.0) - 45.0);
  EXPECT_NEAR(motion.residuals_mm[0], half_mm, 1e-9);
  EXPECT_NEAR(motion.residuals_mm[1], half_mm, 1e-9);
  EXPECT_NEAR(motion.rms_mm, half_mm, 1e-9);
}

TEST(MotionOfPoints, TheThirdPointOfTheThesisTurnsTwoPointsByTheLeastTurn) {
  // Equations 8.11 and 8.12: a3 = a1 + (a2 - a1) x (a2' - a1'), and the same after.
  const std::vector<WantedPoint> two{{"a", {1, 2, 3}, {4, 0, 3}}, {"b", {21, 2, 3}, {20, 9, 8}}};
  const glm::dvec3 third = glm::cross(two[1].from_mm - two[0].from_mm, two[1].to_mm - two[0].to_mm);
  std::vector<WantedPoint> three = two;
  three.push_back({"c", two[0].from_mm + third, two[0].to_mm + third});
  const PointMotion by_two = motion_of_points(two, PointFit::FirstPoint);
  const PointMotion by_three = motion_of_points(three, PointFit::FirstPoint);
  for (int column = 0; column < 4; ++column)
    EXPECT_LT(glm::distance(by_two.moved_from_still[column], by_three.moved_from_still[column]), 1e-9);
}

TEST(MotionOfPoints, ThreePointsOfARigidMotionAreAllBroughtHome) {
  const glm::dmat3 turn = rotation_of({5, -3, 2}, glm::dmat3(1.0));
  std::vector<WantedPoint> wanted;
  for (const glm::dvec3& p : {glm::dvec3(0, -90, -30), glm::dvec3(25, -50, -32), glm::dvec3(-25, -50, -31)})
    wanted.push_back({std::to_string(wanted.size()), p, turn * p + glm::dvec3(1, -6, 2)});
  for (const PointFit fit : {PointFit::Best, PointFit::FirstPoint}) {
    const PointMotion motion = motion_of_points(wanted, fit);
    for (const double residual_mm : motion.residuals_mm) EXPECT_LT(residual_mm, 1e-9);
  }
  EXPECT_LT(motion_of_points({wanted[0]}, PointFit::Best).rms_mm, 1e-12) << "one point is a translation";
}

TEST(MotionOfPoints, WhatLeavesTheTurnOpenIsRefused) {
  const auto refusal = [](const std::vector<WantedPoint>& wanted) -> std::string {
    try {
      motion_of_points(wanted, PointFit::Best);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({}).find("no point"), std::string::npos);
  EXPECT_NE(refusal({{"a", {0, 0, 0}, {1, 0, 0}}, {"b", {0, 0, 0}, {2, 0, 0}}}).find("coincide"),
            std::string::npos);
  EXPECT_NE(refusal({{"a", {0, 0, 0}, {9, 0, 0}}, {"b", {9, 0, 0}, {0, 0, 0}}}).find("third point"),
            std::string::npos);
  EXPECT_NE(refusal({{"a", {0, 0, 0}, {0, 0, 1}}, {"b", {5, 0, 0}, {5, 0, 1}}, {"c", {9, 0, 0}, {9, 0, 1}}})
                .find("one line"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
