// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/seating.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// A board above a block, with a leg down beside it.
Solid clamp(double leg_x_mm) {
  return solid_of(shapes::together(shapes::box({-6, -4, 5.2}, {12, 4, 8}),
                                   shapes::box({leg_x_mm, -3, -6}, {leg_x_mm + 3, 3, 5})));
}

TEST(Seating, ABumpReachesIntoTheWayByWhatItSticksOut) {
  // A block of 5 mm; a bump on its side reaches to x = 5.7 between z = -1 and 1.
  const Solid block = solid_of(
      shapes::together(shapes::box({-5, -5, -5}, {5, 5, 5}), shapes::box({5.0001, -2, -1}, {5.7, 2, 1})));
  const Seating free = seating(clamp(5.75), block, {{0, 0, -1}});
  EXPECT_FALSE(free.binding);
  const Seating binds = seating(clamp(5.25), block, {{0, 0, -1}});
  ASSERT_TRUE(binds.binding);
  EXPECT_NEAR(binds.binding->depth_mm, 0.45, 0.01);
  EXPECT_NEAR(binds.binding->at_mm.x, 5.7, 0.01);
  // The leg's end, at -6, meets a point at height z when it is z + 6 short of its place.
  EXPECT_NEAR(binds.binding->first_mm, binds.binding->at_mm.z + 6.0, 1e-9);
  EXPECT_EQ(binds.binding->last_mm, 0.0);
}

TEST(Seating, ABumpThatTheLegHasPassedBindsOnlyOnTheWay) {
  // The bump lies above the leg's upper end, below the board.
  const Solid block = solid_of(
      shapes::together(shapes::box({-5, -5, -5}, {5, 5, 5.1}), shapes::box({5.1, -2, 5.02}, {5.7, 2, 5.1})));
  const Seating binds = seating(clamp(5.25), block, {{0, 0, -1}});
  ASSERT_TRUE(binds.binding);
  EXPECT_NEAR(binds.binding->depth_mm, 0.45, 0.01);
  EXPECT_GT(binds.binding->last_mm, 0.01);
  EXPECT_GT(binds.binding->first_mm, 11.0);
}

TEST(Seating, TheSameBitsOnOneThreadAndMany) {
  const Solid ball = solid_of(shapes::sphere({0.1, 0.2, 0.3}, 6.0, 4));
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1, 2, -3));
  const Seating many = seating(clamp(5.25), ball, {direction});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Seating alone = seating(clamp(5.25), ball, {direction});
  ASSERT_TRUE(many.binding && alone.binding);
  EXPECT_EQ(many.binding->depth_mm, alone.binding->depth_mm);
  EXPECT_EQ(many.binding->at_mm, alone.binding->at_mm);
}

TEST(Seating, RefusesWhatIsEmptyAndADirectionWithoutLength) {
  const Solid box = solid_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(seating(Solid(), box, {{0, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(seating(box, box, {{0, 0, 0}}), std::invalid_argument);
  EXPECT_THROW(seating(box, box, {{0, 0, 1}, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
