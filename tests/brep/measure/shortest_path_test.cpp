// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/shortest_path.h"

#include <gtest/gtest.h>

#include "brep/mesh/error.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(ShortestPath, OverABoxItIsTheStraightLineOfTheUnfoldedSides) {
  const Mesh box = mesh_of(shapes::box({0, 0, 0}, {4, 2, 3}));
  // Over the edge at y = 0, z = 3: unfolded, (1, -1) to (3.5, 1.5).
  const SurfacePath path = shortest_path(box, {1, 0, 2}, {3.5, 1.5, 3});
  EXPECT_NEAR(path.length_mm, std::hypot(2.5, 2.5), 1e-12);
  EXPECT_EQ(path.points_mm.front(), glm::dvec3(1, 0, 2));
  EXPECT_EQ(path.points_mm.back(), glm::dvec3(3.5, 1.5, 3));
  // Kowalewski's spider and fly in a room of 30 x 12 x 12: 40 over five sides.
  const Mesh room = mesh_of(shapes::box({0, 0, 0}, {30, 12, 12}));
  EXPECT_NEAR(shortest_path(room, {0, 6, 11}, {30, 6, 1}).length_mm, 40.0, 1e-9);
}

TEST(ShortestPath, OnABallItConvergesToTheGreatCircleAndIsTheSameBothWays) {
  const glm::dvec3 from = glm::normalize(glm::dvec3(1, 0.2, 0.3)),
                   to = glm::normalize(glm::dvec3(-0.4, 1, -0.2));
  const double arc = 10.0 * std::acos(glm::dot(from, to));
  double before = 0.0;
  for (int splits = 2; splits <= 4; ++splits) {
    const Mesh ball = mesh_of(shapes::sphere({0, 0, 0}, 10, splits));
    const SurfacePath path = shortest_path(ball, 10.0 * from, 10.0 * to);
    EXPECT_NEAR(path.length_mm, shortest_path(ball, 10.0 * to, 10.0 * from).length_mm, 1e-9);
    EXPECT_LT(path.length_mm, arc);
    if (splits > 2) {
      EXPECT_GT(before / (arc - path.length_mm), 2.5) << splits;
    }
    before = arc - path.length_mm;
  }
}

TEST(ShortestPath, BetweenPiecesThereIsNone) {
  const Mesh two =
      mesh_of(shapes::together(shapes::sphere({0, 0, 0}, 1, 1), shapes::sphere({5, 0, 0}, 1, 1)));
  EXPECT_THROW(shortest_path(two, {0, 0, 1}, {5, 0, 1}), std::runtime_error);
  EXPECT_THROW(shortest_path(Mesh(), {0, 0, 1}, {5, 0, 1}), std::invalid_argument);
}

TEST(ShortestPath, APointFartherOffThanTheSurfaceIsLargeIsRefusedWithItsDistance) {
  const Mesh ball = mesh_of(shapes::sphere({0, 0, 0}, 10, 2));
  EXPECT_NO_THROW(shortest_path(ball, {0, 0, 12}, {12, 0, 0}));
  try {
    shortest_path(ball, {0, 0, 10}, {500, 0, 0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Geometry);
    const std::string said = error.what();
    EXPECT_NE(said.find("(500, 0, 0) mm lies 490 mm"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace octotomy::brep
