// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/sample_volume.h"

#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "verify/phantom/head_phantom.h"

namespace octotomy::verify {
namespace {

const voxel::Box around{{-11.3, -10.7, -12.1}, {12.2, 11.9, 10.8}};

struct Ball {
  glm::dvec3 centre_mm;
  double radius_mm;
  bool operator()(const glm::dvec3& p_mm) const { return glm::length(p_mm - centre_mm) < radius_mm; }
  double volume_mm3() const { return 4.0 / 3.0 * glm::pi<double>() * radius_mm * radius_mm * radius_mm; }
};

// Root mean square of error by stated standard error over balls whose place is not the lattice's.
double rms_in_standard_errors(double step_mm, double bias_mm) {
  double sum = 0.0;
  constexpr int balls = 24;
  for (int i = 0; i < balls; ++i) {
    const Ball ball{{0.37 * std::sin(i), 0.41 * std::cos(3.0 * i), 0.29 * std::sin(5.0 * i)}, 8.0 + 0.05 * i};
    const Ball sampled{ball.centre_mm, ball.radius_mm + bias_mm};
    const SampledVolume volume = sample_volume(around, step_mm, sampled);
    const double errors = (volume.volume_mm3 - ball.volume_mm3()) / volume.standard_error_mm3;
    sum += errors * errors;
  }
  return std::sqrt(sum / balls);
}

TEST(SampleVolume, ErrorsOnBallsAreAsLargeAsTheStandardErrorSays) {
  for (const double step_mm : {1.0, 0.5, 0.25}) {
    const double rms = rms_in_standard_errors(step_mm, 0.0);
    EXPECT_LT(rms, 1.5) << "step " << step_mm;
    EXPECT_GT(rms, 0.3) << "step " << step_mm << ": a standard error this wide says nothing";
  }
}

TEST(SampleVolume, ARadiusATwentiethOfAMillimetreTooLargeIsSeen) {
  EXPECT_GT(rms_in_standard_errors(0.25, 0.05), 5.0);
}

TEST(SampleVolume, TheStandardErrorFallsWithTheSquareOfTheStep) {
  const Ball ball{{0.1, 0.2, 0.3}, 9.0};
  const double coarse = sample_volume(around, 0.8, ball).standard_error_mm3;
  const double fine = sample_volume(around, 0.4, ball).standard_error_mm3;
  EXPECT_NEAR(coarse / fine, 4.0, 0.2);
}

TEST(SampleVolume, ABoxBetweenCellsIsExactAndTheWholeBoxHasNoError) {
  const voxel::Box box{{0, 0, 0}, {10, 6, 4}};
  const auto part = [](const glm::dvec3& p) { return p.x < 3.0 && p.y > 2.0; };
  EXPECT_DOUBLE_EQ(sample_volume(box, 0.5, part).volume_mm3, 3.0 * 4.0 * 4.0);
  const SampledVolume all = sample_volume(box, 0.7, [](const glm::dvec3&) { return true; });
  EXPECT_DOUBLE_EQ(all.volume_mm3, 240.0);
  EXPECT_EQ(all.standard_error_mm3, 0.0);
}

TEST(SampleVolume, RefusesAStepOrBoxWithoutSize) {
  const auto nothing = [](const glm::dvec3&) { return false; };
  EXPECT_THROW(sample_volume(around, 0.0, nothing), std::invalid_argument);
  EXPECT_THROW(sample_volume({{0, 0, 0}, {1, -1, 1}}, 0.1, nothing), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
