// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/register_landmarks.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>
#include <string>

namespace octotomy::brep {
namespace {

std::vector<Landmark> face() {
  return {{"nasion", {0, -90, 30}}, {"sella", {1, -20, 32}},       {"A", {0, -95, -20}},
          {"B", {-1, -88, -60}},    {"left orbit", {35, -80, 20}}, {"right orbit", {-34, -79, 21}}};
}

std::vector<Landmark> moved_marks(std::vector<Landmark> marks, const glm::dmat4& motion) {
  for (Landmark& mark : marks) mark.p_mm = glm::dvec3(motion * glm::dvec4(mark.p_mm, 1.0));
  return marks;
}

double largest_difference(const glm::dmat4& a, const glm::dmat4& b) {
  double worst = 0.0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) worst = std::max(worst, std::abs(a[c][r] - b[c][r]));
  return worst;
}

TEST(RegisterLandmarks, AnyMotionIsRecoveredWhateverTheOrderOfNames) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    const glm::dvec3 axis(any(random), any(random), any(random) + 1.5);
    const double scale = seed % 2 == 0 ? 1.0 : 1.0 + 0.4 * any(random);
    glm::dmat4 motion = glm::translate(glm::dmat4(1.0), 100.0 * glm::dvec3(any(random), any(random), 5.0));
    motion = glm::rotate(motion, 3.14159 * any(random), glm::normalize(axis));
    motion = glm::scale(motion, glm::dvec3(scale));
    auto there = moved_marks(face(), motion);
    std::shuffle(there.begin(), there.end(), random);
    const auto fit =
        register_landmarks(face(), there, seed % 2 == 0 ? MotionModel::rigid : MotionModel::similarity);
    EXPECT_LT(largest_difference(fit.fixed_from_moving, motion), 1e-9) << "seed " << seed;
    EXPECT_LT(fit.rms_mm, 1e-9) << "seed " << seed;
    EXPECT_NEAR(fit.scale, scale, 1e-11) << "seed " << seed;
  }
}

TEST(RegisterLandmarks, NoSmallMotionNearTheAnswerFitsNoisyLandmarksBetter) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  auto there = moved_marks(face(), glm::rotate(glm::dmat4(1.0), 0.4, glm::normalize(glm::dvec3(1, 2, 3))));
  for (Landmark& mark : there) mark.p_mm += glm::dvec3(noise(random), noise(random), noise(random));
  there[2].weight = 5.0;
  const auto fit = register_landmarks(face(), there);
  const auto cost = [&](const glm::dmat4& motion) {
    double sum = 0.0;
    const auto here = moved_marks(face(), motion);
    for (std::size_t k = 0; k < here.size(); ++k) {
      const glm::dvec3 d = here[k].p_mm - there[k].p_mm;
      sum += there[k].weight * glm::dot(d, d);
    }
    return sum;
  };
  EXPECT_GT(fit.rms_mm, 0.3);
  for (int k = 0; k < 3; ++k)
    for (const double step : {-0.01, 0.01}) {
      glm::dvec3 axis(0.0);
      axis[k] = 1.0;
      EXPECT_GT(cost(glm::translate(glm::dmat4(1.0), step * axis) * fit.fixed_from_moving),
                cost(fit.fixed_from_moving));
      EXPECT_GT(cost(glm::rotate(glm::dmat4(1.0), step, axis) * fit.fixed_from_moving),
                cost(fit.fixed_from_moving));
    }
}

TEST(RegisterLandmarks, AMirroredFaceIsTurnedNotReflected) {
  const auto there = moved_marks(face(), glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1)));
  const auto fit = register_landmarks(face(), there);
  EXPECT_NEAR(glm::determinant(glm::dmat3(fit.fixed_from_moving)), 1.0, 1e-12);
  EXPECT_GT(fit.rms_mm, 1.0) << "and the misfit tells";
}

TEST(RegisterLandmarks, NamesInOneSetOnlyAreLeftOutAndTold) {
  auto there = face();
  there[1].name = "turcica";
  const auto fit = register_landmarks(face(), there);
  EXPECT_EQ(fit.left_out, (std::vector<std::string>{"sella", "turcica"}));
  EXPECT_EQ(fit.paired.size(), 5U);
  EXPECT_EQ(fit.residuals_mm.size(), 5U);
}

TEST(RegisterLandmarks, LandmarksThatDoNotFixAMotionAreRefused) {
  auto doubled = face();
  doubled.push_back(doubled.front());
  EXPECT_THROW(register_landmarks(doubled, face()), std::invalid_argument);
  const std::vector<Landmark> line = {{"a", {0, 0, 0}}, {"b", {10, 10, 0}}, {"c", {30, 30, 0.001}}};
  EXPECT_THROW(register_landmarks(line, line), std::invalid_argument);
  const std::vector<Landmark> two(line.begin(), line.begin() + 2);
  EXPECT_THROW(register_landmarks(two, two), std::invalid_argument);
  auto weightless = face();
  weightless[0].weight = 0.0;
  EXPECT_THROW(register_landmarks(weightless, face()), std::invalid_argument);
}

TEST(RegisterLandmarks, ThreePointsTrustTheFirstThenTheDirectionToTheSecond) {
  const glm::dmat4 motion = glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(5, 6, 7)), 0.8,
                                        glm::normalize(glm::dvec3(1, 2, 3)));
  auto there = moved_marks(face(), motion);
  EXPECT_LT(largest_difference(register_landmarks(face(), there, MotionModel::three_points).fixed_from_moving,
                               motion),
            1e-12);
  // The second pair is off only in its distance, the third only in its position in the plane, the others in
  // any way: none of that may turn the answer.
  there[1].p_mm += 2.5 * glm::normalize(there[1].p_mm - there[0].p_mm);
  there[2].p_mm += 3.0 * (there[1].p_mm - there[0].p_mm) + 0.5 * (there[2].p_mm - there[0].p_mm);
  for (std::size_t k = 3; k < there.size(); ++k) there[k].p_mm += glm::dvec3(1.0, -2.0, 3.0);
  const LandmarkFit fit = register_landmarks(face(), there, MotionModel::three_points);
  EXPECT_LT(largest_difference(fit.fixed_from_moving, motion), 1e-12);
  EXPECT_LT(fit.residuals_mm[0], 1e-12);
  EXPECT_NEAR(fit.residuals_mm[1], 2.5, 1e-12);
  // Least squares distributes the same errors over all pairs, including the first.
  EXPECT_GT(register_landmarks(face(), there).residuals_mm[0], 1.0);
}

TEST(RegisterLandmarks, ThreePointsOnALineAreRefusedThoughOthersLieBesideIt) {
  std::vector<Landmark> marks = {{"a", {0, 0, 0}}, {"b", {10, 0, 0}}, {"c", {20, 0, 0}}, {"d", {0, 9, 3}}};
  EXPECT_NO_THROW(register_landmarks(marks, marks));
  EXPECT_THROW(register_landmarks(marks, marks, MotionModel::three_points), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
