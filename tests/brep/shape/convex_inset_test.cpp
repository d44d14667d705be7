// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/convex_inset.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

Solid box_of(const glm::dvec3& edges) {
  return solid_of(shapes::box({0, 0, 0}, edges));
}

glm::dmat4 turn(int i) {
  return glm::rotate(glm::dmat4(1.0), 0.7 * i, glm::normalize(glm::dvec3(1, i, 3)));
}

TEST(ConvexInset, ABoxKeepsItsEdgesInAnyPose) {
  for (int i = 0; i < 8; ++i)
    for (const double depth : {0.5, 4.0, 9.0, 9.999}) {
      const std::optional<Solid> inset = convex_inset(moved(box_of({20, 30, 40}), turn(i)), depth);
      ASSERT_TRUE(inset) << i;
      const double truth = (20 - 2 * depth) * (30 - 2 * depth) * (40 - 2 * depth);
      EXPECT_NEAR(volume_mm3(*inset), truth, 1e-7 * truth + 1e-6) << i << " " << depth;
      EXPECT_EQ(inset->triangles().points_mm.size(), 8u) << i;
      EXPECT_TRUE(health(*inset).solid()) << i;
    }
}

TEST(ConvexInset, AnIcosahedronShrinksToASimilarOneAndABallsSidesMeetAsTheyShould) {
  const Solid icosahedron = solid_of(shapes::sphere({0, 0, 0}, 10, 0));
  const double depth_of_sides = 10 * std::sqrt((5 + 2 * std::sqrt(5.0)) / 15);
  const std::optional<Solid> inset = convex_inset(icosahedron, 2.0);
  ASSERT_TRUE(inset);
  EXPECT_NEAR(volume_mm3(*inset) / volume_mm3(icosahedron), std::pow(1 - 2 / depth_of_sides, 3), 1e-9);

  const Solid ball = solid_of(shapes::sphere({1, 2, 3}, 10, 3));
  const std::optional<Solid> core = convex_inset(ball, 4.0);
  ASSERT_TRUE(core);
  EXPECT_TRUE(health(*core).solid());
  const std::vector<double> depths = ball.tree().distances_mm(core->triangles().points_mm);
  for (const double depth : depths) EXPECT_NEAR(depth, 4.0, 1e-6);
}

TEST(ConvexInset, NothingIsLeftBelowTheDeepestPoint) {
  const std::optional<Solid> inset = convex_inset(box_of({20, 30, 40}), 10.5);
  ASSERT_TRUE(inset);
  EXPECT_TRUE(inset->empty());
}

TEST(ConvexInset, ASlitAnInwardCornerACavityAndTwoPiecesAreNotConvex) {
  Triangles dented = shapes::sphere({0, 0, 0}, 10, 3);
  dented.points_mm[100] *= 0.99;
  EXPECT_FALSE(convex_inset(trusted_solid(dented, Proof::Connection), 1.0));
  EXPECT_FALSE(convex_inset(solid_of(shapes::together(shapes::box({0, 0, 0}, {9, 9, 9}),
                                                      shapes::inside_out(shapes::box({3, 3, 3}, {4, 4, 4})))),
                            1.0));
  EXPECT_FALSE(convex_inset(
      solid_of(shapes::together(shapes::box({0, 0, 0}, {9, 9, 9}), shapes::box({10, 0, 0}, {19, 9, 9}))),
      1.0));
  EXPECT_FALSE(convex_inset(Solid(), 1.0));
}

TEST(ConvexInset, Stops) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(convex_inset(box_of({1, 1, 1}), 0.1, {.stop = stop.get_token()}), Stopped);
}

}  // namespace
}  // namespace octotomy::brep
