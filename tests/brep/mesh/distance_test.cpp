// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/distance.h"

#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::vector<glm::dvec3> random_points(std::size_t count, double reach, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

double distance_to_box(const glm::dvec3& p, const glm::dvec3& half) {
  const glm::dvec3 q = glm::abs(p) - half;
  const double outside = glm::length(glm::max(q, glm::dvec3(0.0)));
  return outside > 0.0 ? outside : std::abs(std::max({q.x, q.y, q.z}));
}

TEST(SurfaceTree, ABoxsDistancesAndInsideHaveClosedForms) {
  const glm::dvec3 half(1, 2, 3);
  const SurfaceTree tree(mesh_of(shapes::box(-half, half)));
  const auto points = random_points(5000, 4.0, 1);
  const auto distances = tree.distances_mm(points);
  const auto inside = tree.inside(points);
  int inside_count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(distances[i], distance_to_box(points[i], half), 1e-14) << "point " << i;
    const glm::dvec3 q = glm::abs(points[i]) - half;
    EXPECT_EQ(inside[i] != 0, std::max({q.x, q.y, q.z}) < 0.0) << "point " << i;
    inside_count += inside[i];
  }
  EXPECT_GT(inside_count, 100);
}

TEST(SurfaceTree, RaysThroughEdgesAndVerticesCountOnce) {
  // Octahedra: rays along x from these points run into vertices and along edges.
  Triangles t;
  t.points_mm = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  t.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const SurfaceTree tree(t);
  const auto inside = tree.inside({{0, 0, 0},
                                   {-0.5, 0, 0},
                                   {-2, 0, 0},
                                   {-2, 0.5, 0},
                                   {-2, 0, 0.5},
                                   {-2, 0, 1},
                                   {-2, 1, 0},
                                   {0, 0.25, 0},
                                   {0, 0, 0.25},
                                   {2, 0, 0}});
  EXPECT_EQ(inside, (std::vector<std::uint8_t>{1, 1, 0, 0, 0, 0, 0, 1, 1, 0}));
}

TEST(SurfaceTree, CrossingsTellEnteringFromLeaving) {
  const SurfaceTree tree(shapes::box({0, 0, 0}, {1, 1, 1}));
  const auto crossings = tree.crossings({-1, 0.25, 0.5});
  ASSERT_EQ(crossings.size(), 2u);
  EXPECT_NE(crossings[0].leaving, crossings[1].leaving);
  const auto from_inside = tree.crossings({0.5, 0.25, 0.5});
  ASSERT_EQ(from_inside.size(), 1u);
  EXPECT_TRUE(from_inside[0].leaving);
  EXPECT_GE(from_inside[0].face, 10u);  // the last two triangles of a box face +x
}

TEST(SurfaceTree, ASphereOfManyTrianglesAgreesWithEveryTriangleAskedAlone) {
  const Triangles sphere = shapes::sphere({0.1, 0.2, 0.3}, 1, 3);
  const SurfaceTree tree(sphere);
  const auto points = random_points(50, 2.0, 2);
  const auto distances = tree.distances_mm(points);
  std::vector<double> nearest(points.size(), INFINITY);
  for (const auto& face : sphere.faces) {
    Triangles one;
    one.points_mm = sphere.points_mm;
    one.faces = {face};
    const auto alone = SurfaceTree(one).distances_mm(points);
    for (std::size_t i = 0; i < points.size(); ++i) nearest[i] = std::min(nearest[i], alone[i]);
  }
  EXPECT_EQ(distances, nearest);
}

TEST(SurfaceTree, ThreadsDoNotChangeTheBits) {
  const SurfaceTree tree(shapes::sphere({0, 0, 0}, 1, 4));
  const auto points = random_points(2000, 1.5, 3);
  const auto many = tree.distances_mm(points);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(tree.distances_mm(points), many);
}

TEST(SurfaceTree, OfNothingHasNoDistanceAndNoInside) {
  const SurfaceTree tree{Triangles{}};
  EXPECT_THROW(tree.distances_mm({{0, 0, 0}}), std::invalid_argument);
  EXPECT_EQ(tree.inside({{0, 0, 0}}), std::vector<std::uint8_t>{0});
}

}  // namespace
}  // namespace octotomy::brep
