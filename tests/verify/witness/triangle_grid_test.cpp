// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/triangle_grid.h"

#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "brep/mesh/distance.h"
#include "brep/mesh/solid.h"
#include "tests/brep/shapes.h"

namespace octotomy::verify {
namespace {

constexpr double any_distance_mm = std::numeric_limits<double>::infinity();

/// A box with corners at whole millimetres, so that rays through whole numbers pass through sides and corners.
brep::Triangles box_of_whole_millimetres() {
  return brep::shapes::box({0, 0, 0}, {4, 6, 8});
}

TEST(TriangleGrid, DistancesToABoxAreThoseOfItsSidesEdgesAndCorners) {
  const TriangleGrid grid(box_of_whole_millimetres());
  EXPECT_DOUBLE_EQ(grid.nearest({2, 3, 9}, any_distance_mm)->distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(grid.nearest({7, 10, 4}, any_distance_mm)->distance_mm, 5.0);
  EXPECT_DOUBLE_EQ(grid.nearest({5, 8, 10}, any_distance_mm)->distance_mm, 3.0);
  EXPECT_DOUBLE_EQ(grid.nearest({2, 3, 4}, any_distance_mm)->distance_mm, 2.0);
  EXPECT_DOUBLE_EQ(grid.nearest({1004, 3, 4}, any_distance_mm)->distance_mm, 1000.0);
  EXPECT_FALSE(grid.nearest({2, 3, 9}, 0.999));
  EXPECT_TRUE(grid.has_within({2, 3, 9}, 1.0));
  EXPECT_FALSE(grid.has_within({2, 3, 9}, 0.999));
  const auto foot = grid.nearest({1, 2, 9}, any_distance_mm);
  glm::dvec3 at(0.0);
  for (std::size_t k = 0; k < 3; ++k)
    at += foot->weights[static_cast<int>(k)] *
          grid.triangles().points_mm[grid.triangles().faces[foot->face][k]];
  EXPECT_LT(glm::distance(at, {1, 2, 8}), 1e-12);
}

TEST(TriangleGrid, ARayThroughEdgesAndCornersCrossesOnce) {
  const TriangleGrid grid(box_of_whole_millimetres());
  int inside = 0;
  for (int z = -2; z <= 10; ++z)
    for (int y = -2; y <= 8; ++y)
      for (int x = -2; x <= 6; ++x)
        if (grid.has_inside({x + 0.5, y, z})) ++inside;
  // The half-open rule: rays at one of two opposite sides count, those at the other do not.
  EXPECT_EQ(inside, 4 * 6 * 8);
}

TEST(TriangleGrid, AgreesWithTheSearchTreeOnATorusAndFarFromIt) {
  const brep::Solid solid =
      brep::trusted_solid(brep::shapes::torus(10.0, 3.0, 48, 24), brep::Proof::Construction);
  const TriangleGrid grid(solid.triangles());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> coordinate(-20.0, 20.0);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), 0.3 * coordinate(random));
    EXPECT_NEAR(grid.nearest(p, any_distance_mm)->distance_mm, solid.tree().distances_mm({p}).front(), 1e-9)
        << i;
    const bool is_inside = grid.has_inside(p);
    EXPECT_EQ(is_inside, brep::is_inside(p, solid.triangles())) << i;
    inside += is_inside ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
}

TEST(TriangleGrid, NothingIsNearNoTriangles) {
  const TriangleGrid grid{brep::Triangles{}};
  EXPECT_FALSE(grid.nearest({0, 0, 0}, any_distance_mm));
  EXPECT_FALSE(grid.has_within({0, 0, 0}, any_distance_mm));
  EXPECT_FALSE(grid.has_inside({0, 0, 0}));
}

}  // namespace
}  // namespace octotomy::verify
