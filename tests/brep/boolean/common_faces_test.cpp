// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/common_faces.h"

#include <gtest/gtest.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(CommonFaces, ThePiecesOfACutBecomeTheWholeAgain) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 10.0, 4));
  const Solid mask = solid_of(shapes::box({-11, -11, 1.3}, {11, 11, 11}));
  const Solid above = boolean(ball, Operation::Intersection, mask).solid,
              below = boolean(ball, Operation::Difference, mask).solid;
  const std::optional<Solid> whole = united_at_common_faces(below, above);
  ASSERT_TRUE(whole.has_value());
  EXPECT_NEAR(whole->measures().volume_mm3, ball.measures().volume_mm3, 1e-9);
  EXPECT_NEAR(whole->measures().area_mm2, ball.measures().area_mm2, 1e-9);
  EXPECT_EQ(health(whole->triangles()).findings, std::vector<std::string>());
}

TEST(CommonFaces, ThereAreNoneBetweenSolidsThatAreApartOrOnlyTouch) {
  const Solid box = solid_of(shapes::box({0, 0, 0}, {2, 2, 2}));
  EXPECT_FALSE(united_at_common_faces(box, solid_of(shapes::box({3, 0, 0}, {4, 2, 2}))).has_value());
  // Its face is part of a larger one.
  EXPECT_FALSE(united_at_common_faces(box, solid_of(shapes::box({2, 0.5, 0.5}, {3, 1.5, 1.5}))).has_value());
}

}  // namespace
}  // namespace octotomy::brep
