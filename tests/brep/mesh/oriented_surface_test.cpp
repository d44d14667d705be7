// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/oriented_surface.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "brep/mesh/distance.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::vector<glm::dvec3> random_points(std::size_t count, double reach) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

/// A star: every second tip of an octahedron-like body is a needle, so that feet on sharp edges and corners
/// abound, where the sign by any single triangle's normal is wrong.
Triangles star() {
  Triangles t = shapes::sphere({0, 0, 0}, 1, 1);
  for (std::size_t v = 0; v < 12; ++v) t.points_mm[v] *= 3.0;
  return t;
}

TEST(OrientedSurface, ItsSignIsParitysOnABodyOfNeedles) {
  const Triangles body = star();
  const auto points = random_points(4000, 3.0);
  const auto feet = OrientedSurface(mesh_of(body)).feet(points);
  const SurfaceTree tree(body);
  const auto inside = tree.inside(points);
  const auto distances = tree.distances_mm(points);
  std::size_t within = 0, at_corners = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(feet[i].distance_mm < 0.0, inside[i] != 0) << "point " << i;
    EXPECT_EQ(std::abs(feet[i].distance_mm), distances[i]) << "point " << i;
    EXPECT_NEAR(glm::distance(feet[i].p_mm, points[i]), distances[i], 1e-14) << "point " << i;
    EXPECT_FALSE(feet[i].on_border);
    within += inside[i];
    const glm::dvec3 way = points[i] - feet[i].p_mm;
    at_corners += std::abs(glm::dot(way, feet[i].normal)) < 0.9 * glm::length(way);
  }
  EXPECT_GT(within, 100u);
  EXPECT_GT(at_corners, 100u);
}

TEST(OrientedSurface, TurnedInsideOutEverySignTurns) {
  const auto points = random_points(300, 3.0);
  const auto feet = OrientedSurface(mesh_of(star())).feet(points);
  const auto turned = OrientedSurface(mesh_of(shapes::inside_out(star()))).feet(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(feet[i].distance_mm<0.0, turned[i].distance_mm> 0.0) << "point " << i;
}

TEST(OrientedSurface, AFootOnTheBorderOfAnOpenSurfaceSaysSo) {
  Triangles open = shapes::box({0, 0, 0}, {2, 2, 2});
  open.faces.erase(open.faces.begin(), open.faces.begin() + 2);  // without its side at low z
  const auto feet =
      OrientedSurface(mesh_of(open)).feet({{1, 1, -1}, {0.5, 1, 1}, {-1, 1, -1}, {1, 1, 3}, {-1, -1, -1}});
  EXPECT_TRUE(feet[0].on_border);
  EXPECT_FALSE(feet[1].on_border);
  EXPECT_NEAR(feet[1].distance_mm, -0.5, 1e-15);
  EXPECT_TRUE(feet[2].on_border);
  EXPECT_FALSE(feet[3].on_border);
  EXPECT_NEAR(feet[3].distance_mm, 1.0, 1e-15);
  EXPECT_TRUE(feet[4].on_border);
}

TEST(OrientedSurface, ThreadsDoNotChangeTheBits) {
  const OrientedSurface surface(mesh_of(star()));
  const auto points = random_points(3000, 3.0);
  const auto many = surface.feet(points);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = surface.feet(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(many[i].p_mm, alone[i].p_mm);
    EXPECT_EQ(many[i].normal, alone[i].normal);
    EXPECT_EQ(many[i].distance_mm, alone[i].distance_mm);
  }
}

}  // namespace
}  // namespace octotomy::brep
