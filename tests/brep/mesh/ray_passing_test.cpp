// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/ray_passing.h"

#include <cmath>
#include <gtest/gtest.h>

namespace octotomy::brep {
namespace {

const glm::dvec3 corner_a(2, 0, 0), corner_b(2, 1, 0), corner_c(2, 0, 1);  // its normal is +x

TEST(RayPassing, LeavesWhereTheTriangleFacesAheadAndEntersWhereItFacesBack) {
  const glm::dvec3 from(0, 0.25, 0.25);
  EXPECT_EQ(passing_of(from, corner_a, corner_b, corner_c), RayPassing::Leaving);
  EXPECT_EQ(passing_of(from, corner_a, corner_c, corner_b), RayPassing::Entering);
  EXPECT_EQ(passing_of({3, 0.25, 0.25}, corner_a, corner_b, corner_c), RayPassing::Beside);
  EXPECT_EQ(passing_of({0, 0.75, 0.75}, corner_a, corner_b, corner_c), RayPassing::Beside);
}

TEST(RayPassing, GoesThroughOneTriangleOfTwoAtTheirSideAndOfAFanAtItsPoint) {
  const glm::dvec3 d(2, 1, 1);
  int at_side = 0, at_point = 0;
  at_side += passing_of({0, 0.5, 0.5}, corner_a, corner_b, corner_c) != RayPassing::Beside;
  at_side += passing_of({0, 0.5, 0.5}, corner_b, d, corner_c) != RayPassing::Beside;
  EXPECT_EQ(at_side, 1);
  const glm::dvec3 middle(2, 0.5, 0.5), round[] = {corner_a, corner_b, d, corner_c};
  for (int i = 0; i < 4; ++i)
    at_point += passing_of({0, 0.5, 0.5}, middle, round[i], round[(i + 1) % 4]) != RayPassing::Beside;
  EXPECT_EQ(at_point, 1);
}

TEST(RayPassing, IsExactBesideAnObliquePlane) {
  // The point is off the plane x + y + z = 1 by one unit in the last place of x.
  const glm::dvec3 p(1, 0, 0), q(0, 1, 0), r(0, 0, 1);
  const double x = 0.5;
  EXPECT_EQ(passing_of({std::nextafter(x, 0.0), 0.25, 0.25}, p, q, r), RayPassing::Leaving);
  EXPECT_EQ(passing_of({std::nextafter(x, 1.0), 0.25, 0.25}, p, q, r), RayPassing::Beside);
}

}  // namespace
}  // namespace octotomy::brep
