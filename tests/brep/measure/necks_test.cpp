// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/necks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// Two balls of radius 1 whose middles are a length apart along an oblique line; they meet in a neck.
Solid two_balls(double apart_mm) {
  const glm::dvec3 half = 0.5 * apart_mm * glm::normalize(glm::dvec3(1.0, 0.4, 0.3));
  const auto ball = [](const glm::dvec3& middle_mm) {
    return trusted_solid(shapes::sphere(middle_mm, 1.0, 4), Proof::Health);
  };
  return boolean(ball(-half), Operation::Union, ball(half)).solid;
}

TEST(Necks, BetweenTwoBallsThatOverlapIsAsWideAsTheirCommonCircle) {
  for (const double width_mm : {0.2, 0.5, 1.0}) {
    const Solid solid = two_balls(2.0 * std::sqrt(1.0 - 0.25 * width_mm * width_mm));
    const std::vector<Neck> found = necks(solid, {.below_mm = width_mm + 0.1});
    ASSERT_FALSE(found.empty()) << width_mm;
    // The flat triangles of a ball lie within 0.003 of its radius, so the circle is narrower by more than that.
    for (const Neck& neck : found) {
      EXPECT_NEAR(neck.width_mm, width_mm, 0.06) << width_mm;
      EXPECT_LT(glm::length(neck.middle_mm), 0.06) << width_mm;
    }
    EXPECT_TRUE(necks(solid, {.below_mm = width_mm - 0.1}).empty()) << width_mm;
  }
}

TEST(Necks, ThinPartsWithoutReentrantEdgesAreNone) {
  const Solid plate = trusted_solid(shapes::box({0, 0, 0}, {10, 10, 0.2}), Proof::Health);
  EXPECT_TRUE(necks(plate, {.below_mm = 1.0}).empty());
  const Solid ball = trusted_solid(shapes::sphere({0, 0, 0}, 0.3, 3), Proof::Health);
  EXPECT_TRUE(necks(ball, {.below_mm = 1.0}).empty());
}

TEST(Necks, InAWideInnerCornerAreNone) {
  const Solid one = trusted_solid(shapes::box({0, 0, 0}, {10, 4, 4}), Proof::Health),
              other = trusted_solid(shapes::box({2, 0.5, 2}, {6, 3.5, 12}), Proof::Health);
  EXPECT_TRUE(necks(boolean(one, Operation::Union, other).solid, {.below_mm = 2.0}).empty());
}

TEST(Necks, AreTheSameOnAnyNumberOfThreads) {
  const Solid solid = two_balls(1.98);
  const std::vector<Neck> many = necks(solid, {.below_mm = 1.0});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Neck> alone = necks(solid, {.below_mm = 1.0});
  ASSERT_EQ(many.size(), alone.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many[i].middle_mm, alone[i].middle_mm);
    EXPECT_EQ(many[i].width_mm, alone[i].width_mm);
  }
}

TEST(Necks, RefuseAnEmptySolidAndAnglesOutOfRange) {
  EXPECT_THROW(necks(Solid(), {}), InvalidInput);
  const Solid plate = trusted_solid(shapes::box({0, 0, 0}, {1, 1, 1}), Proof::Health);
  EXPECT_THROW(necks(plate, {.below_mm = 0.0}), InvalidInput);
  EXPECT_THROW(necks(plate, {.reentrant_deg = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace octotomy::brep
