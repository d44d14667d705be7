// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/landmark_motion.h"

#include <gtest/gtest.h>
#include <random>
#include <stdexcept>

#include "brep/align/landmark_warp.h"

namespace octotomy::verify {
namespace {

const std::vector<glm::dvec3> places_mm{{0, -100, 0}, {0, -95, -20}, {12, -90, -30}, {-3, -99, 14}};
const std::vector<glm::dvec3> shifts_mm{{0, -2, 1}, {0.5, -3, 0}, {0, 0, 0}, {0, -1, 0.3}};

TEST(LandmarkMotion, DisplacementsAreThoseOfTheOtherCodeAndTheOriginOfAMovedPointIsThePoint) {
  const LandmarkMotion own(places_mm, shifts_mm, 40.0);
  const brep::LandmarkWarp other(places_mm, shifts_mm, 40.0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  double largest_mm = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 p = glm::dvec3(0, -95, -5) + 60.0 * glm::dvec3(any(random), any(random), any(random));
    const glm::dvec3 by = own.displacement_mm(p);
    largest_mm = std::max(largest_mm, glm::length(by));
    EXPECT_LT(glm::distance(by, other.at(p)), 1e-12) << i;
    const auto origin = own.origin_mm(p + by);
    ASSERT_TRUE(origin) << i;
    EXPECT_LT(glm::distance(*origin, p), 1e-9) << i;
  }
  EXPECT_GT(largest_mm, 1.0);
}

TEST(LandmarkMotion, LandmarksNeedADisplacementEachAndAPlaceOfTheirOwn) {
  EXPECT_THROW(LandmarkMotion({}, {}, 40.0), std::invalid_argument);
  EXPECT_THROW(LandmarkMotion(places_mm, {{0, 0, 0}}, 40.0), std::invalid_argument);
  EXPECT_THROW(LandmarkMotion({{1, 2, 3}, {1, 2, 3}}, {{0, 0, 0}, {0, 0, 1}}, 40.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
