// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/triangle_grid.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

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

TEST(TriangleGrid, ASearchThatMayEndEarlyEndsBelowWhatIsEnoughOrAtTheLeast) {
  const TriangleGrid grid(brep::shapes::torus(10.0, 3.0, 48, 24));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> coordinate(-16.0, 16.0);
  int early = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p(coordinate(random), coordinate(random), 0.3 * coordinate(random));
    const auto least = grid.nearest(p, any_distance_mm), any = grid.nearest(p, any_distance_mm, 2.0);
    ASSERT_TRUE(least && any);
    EXPECT_GE(any->distance_mm, least->distance_mm);
    if (least->distance_mm < 2.0) {
      EXPECT_LT(any->distance_mm, 2.0);
      early += any->distance_mm > least->distance_mm;
      continue;
    }
    EXPECT_EQ(any->distance_mm, least->distance_mm);
    EXPECT_EQ(any->face, least->face);
    EXPECT_EQ(any->weights, least->weights);
  }
  EXPECT_GT(early, 50);
}

TEST(TriangleGrid, NoTriangleThatIsPassedOverIsNearer) {
  const brep::Triangles torus = brep::shapes::torus(10.0, 3.0, 24, 12);
  const TriangleGrid grid(torus);
  std::vector<TriangleGrid> alone;  // one triangle each: nothing is passed over
  for (const auto& face : torus.faces) alone.emplace_back(brep::Triangles{torus.points_mm, {face}});
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> coordinate(-16.0, 16.0);
  for (std::size_t i = 0; i < 300; ++i) {
    // Corners as well, where several triangles are equally near.
    const glm::dvec3 p =
        i < 100 ? torus.points_mm[i] : glm::dvec3(coordinate(random), coordinate(random), coordinate(random));
    TriangleGrid::Foot least{any_distance_mm};
    for (std::uint32_t face = 0; face < alone.size(); ++face)
      if (const auto foot = alone[face].nearest(p, any_distance_mm); foot->distance_mm < least.distance_mm)
        least = {foot->distance_mm, face, foot->weights};
    const auto found = grid.nearest(p, any_distance_mm);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->distance_mm, least.distance_mm);
    EXPECT_EQ(found->face, least.face);
    EXPECT_EQ(found->weights, least.weights);
    EXPECT_TRUE(grid.has_within(p, least.distance_mm));
    if (least.distance_mm > 0.0) {
      EXPECT_FALSE(grid.has_within(p, std::nextafter(least.distance_mm, 0.0)));
    }
  }
}

TEST(TriangleGrid, NothingIsNearNoTriangles) {
  const TriangleGrid grid{brep::Triangles{}};
  EXPECT_FALSE(grid.nearest({0, 0, 0}, any_distance_mm));
  EXPECT_FALSE(grid.has_within({0, 0, 0}, any_distance_mm));
  EXPECT_FALSE(grid.has_inside({0, 0, 0}));
}

}  // namespace
}  // namespace octotomy::verify
