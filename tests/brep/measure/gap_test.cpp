// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/gap.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/mesh/distance.h"
#include "brep/mesh/move.h"
#include "brep/mesh/sample_surface.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

const Triangles cube_of_2 = shapes::box({0, 0, 0}, {2, 2, 2});

TEST(Gap, FaceToFaceCornerToFaceAndCornerToCornerHaveTheirClosedForms) {
  EXPECT_NEAR(gap(cube_of_2, shapes::box({2.5, 0.5, 0.5}, {3, 1, 1})).distance_mm, 0.5, 1e-15);
  const Gap corners = gap(cube_of_2, shapes::box({3, 4, 4}, {5, 6, 7}));
  EXPECT_NEAR(corners.distance_mm, 3.0, 1e-15);
  EXPECT_EQ(corners.on_a_mm, glm::dvec3(2, 2, 2));
  EXPECT_EQ(corners.on_b_mm, glm::dvec3(3, 4, 4));
}

TEST(Gap, EdgesThatPassEachOtherAreNearerThanAnyCorner) {
  // A roof's ridge along x over one along y.
  const Triangles ridge{
      {{-5, 0, 0}, {5, 0, 0}, {-5, 3, -4}, {5, 3, -4}, {-5, -3, -4}, {5, -3, -4}},
      {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}}};
  Triangles other = ridge;
  for (glm::dvec3& p : other.points_mm) p = {p.y, p.x, 1.25 - p.z};
  const Gap between = gap(ridge, other);
  EXPECT_NEAR(between.distance_mm, 1.25, 1e-15);
  EXPECT_LT(glm::distance(between.on_a_mm, glm::dvec3(0, 0, 0)), 1e-14);
  EXPECT_LT(glm::distance(between.on_b_mm, glm::dvec3(0, 0, 1.25)), 1e-14);
}

TEST(Gap, MeetingSurfacesHaveNoneAndAPointInCommon) {
  const Triangles a = cube_of_2, b = shapes::box({1, 1, 1}, {3, 3, 3});
  const Gap none = gap(a, b);
  EXPECT_EQ(none.distance_mm, 0.0);
  EXPECT_LT(SurfaceTree(a).distances_mm({none.on_a_mm})[0], 1e-14);
  EXPECT_LT(SurfaceTree(b).distances_mm({none.on_b_mm})[0], 1e-14);
  // One within the other keeps the surfaces' distance.
  EXPECT_NEAR(gap(a, shapes::box({0.5, 0.5, 0.75}, {1, 1, 1})).distance_mm, 0.5, 1e-15);
}

TEST(Gap, NoSampleOfEitherSurfaceIsNearer) {
  int edges = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(any(random), any(random), any(random)));
    const glm::dmat4 motion = glm::rotate(glm::translate(glm::dmat4(1.0), 4.0 * axis), 3.0 * any(random),
                                          glm::normalize(glm::dvec3(any(random), any(random), 1.5)));
    const Mesh a = mesh_of(cube_of_2), b = moved(mesh_of(cube_of_2), motion);
    const Gap found = gap(triangles_of(a), triangles_of(b));
    if (found.distance_mm == 0.0) continue;
    EXPECT_NEAR(glm::distance(found.on_a_mm, found.on_b_mm), found.distance_mm, 1e-12) << "seed " << seed;
    const SurfaceSamples samples = sample_surface(a, 0.05);
    const auto distances = SurfaceTree(b).distances_mm(samples.points_mm);
    const double least = *std::min_element(distances.begin(), distances.end());
    EXPECT_GE(least, found.distance_mm - 1e-12) << "seed " << seed;
    EXPECT_LE(least, found.distance_mm + samples.reach_mm) << "seed " << seed;
    EXPECT_NEAR(gap(triangles_of(b), triangles_of(a)).distance_mm, found.distance_mm, 1e-12)
        << "seed " << seed;
    // Neither end is a corner.
    const auto is_corner = [](const Mesh& mesh, const glm::dvec3& p) {
      for (const auto v : mesh.vertices())
        if (glm::distance(glm::dvec3(mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]), p) < 1e-9)
          return true;
      return false;
    };
    edges += !is_corner(a, found.on_a_mm) && !is_corner(b, found.on_b_mm);
  }
  EXPECT_GT(edges, 3);
}

TEST(Gap, OfFineSurfacesIsThatOfAllCornersAndEdges) {
  // Two bumpy balls beside each other, and one within a larger one.
  const auto bumpy = [](double radius, const glm::dvec3& centre, int seed) {
    Triangles ball = shapes::sphere({0, 0, 0}, radius, 4);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::uniform_real_distribution<double> bump(0.97, 1.03);
    for (glm::dvec3& p : ball.points_mm) p = centre + bump(random) * p;
    return ball;
  };
  const Triangles a = bumpy(10.0, {0, 0, 0}, 1);
  for (const Triangles& b : {bumpy(8.0, {15, 9, 8}, 2), bumpy(14.0, {0.5, 0.2, 0}, 3)}) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [corners, surface] : {std::pair(&a, &b), std::pair(&b, &a)})
      for (const double distance : SurfaceTree(*surface).distances_mm(corners->points_mm))
        least = std::min(least, distance);
    const Gap found = gap(a, b);
    ASSERT_GT(found.distance_mm, 0.0);
    EXPECT_LE(found.distance_mm, least + 1e-12);
    EXPECT_GE(found.distance_mm, least - 0.5) << "edges that pass each other take little off";
    EXPECT_NEAR(SurfaceTree(a).distances_mm({found.on_a_mm})[0], 0.0, 1e-12);
    EXPECT_NEAR(SurfaceTree(b).distances_mm({found.on_b_mm})[0], 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(found.on_a_mm, found.on_b_mm), found.distance_mm, 1e-12);
  }
}

TEST(Gap, RefusesNothing) {
  EXPECT_THROW(gap(Triangles(), cube_of_2), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
