// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/voxelise.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

#include "tests/convert/surfaces.h"
#include "tests/unit_universe.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::octahedron;
using tests::together;
using tests::unit_universe;

/// Voxel (0, 0, 0) at the origin, edges of one millimetre: millimetres are voxel numbers.
/// How often the surface winds about a point, by solid angles: another method than rays.
double winding_by_solid_angles(const brep::Triangles& t, const glm::dvec3& p) {
  double angle = 0.0;
  for (const auto& [i, j, k] : t.faces) {
    const glm::dvec3 a = t.points_mm[i] - p;
    const glm::dvec3 b = t.points_mm[j] - p;
    const glm::dvec3 c = t.points_mm[k] - p;
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    angle += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                              la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// The first voxel that contradicts the winding number, or none.
std::optional<glm::ivec3> first_unlike_winding(const voxel::Octree& octree, const brep::Triangles& t) {
  const int side = octree.universe().side();
  const voxel::Lattice lattice = octree.universe().lattice();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (octree.contains({x, y, z}) != (winding_by_solid_angles(t, lattice.lps_mm({x, y, z})) > 0.5))
          return glm::ivec3(x, y, z);
  return std::nullopt;
}

TEST(Voxelise, ABoxBetweenVoxelCentresHoldsItsVoxelsExactly) {
  const voxel::Octree octree =
      voxelise(unit_universe(5), brep::linked(box({1.5, 2.5, 3.5}, {20.5, 9.5, 30.5})));
  EXPECT_EQ(octree.voxel_count(), 19U * 7U * 27U);
  EXPECT_TRUE(octree.contains({2, 3, 4}));
  EXPECT_TRUE(octree.contains({20, 9, 30}));
  EXPECT_FALSE(octree.contains({21, 9, 30}));
}

TEST(Voxelise, ABoxWithItsFacesOnVoxelCentresTakesTheLowerOnes) {
  const voxel::Octree octree = voxelise(unit_universe(5), brep::linked(box({3, 4, 5}, {13, 11, 30})));
  EXPECT_EQ(octree.voxel_count(), 10U * 7U * 25U);
  EXPECT_TRUE(octree.contains({3, 4, 5}));
  EXPECT_FALSE(octree.contains({13, 4, 5}));
  EXPECT_FALSE(octree.contains({3, 11, 5}));
  EXPECT_FALSE(octree.contains({3, 4, 30}));
}

TEST(Voxelise, VerticesAndEdgesOnRowsOfVoxelCentresDoNotLeak) {
  // Every vertex and every edge of the octahedron lies on rows of centres. Strictly inside are the points of
  // |x| + |y| + |z| <= r - 1, in number (2n + 1)(2n^2 + 2n + 3) / 3 with n = r - 1.
  const int r = 9;
  const voxel::Octree octree = voxelise(unit_universe(5), brep::linked(octahedron({15, 16, 14}, r)));
  std::uint64_t strictly = 0;
  std::uint64_t boundary = 0;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const int distance = std::abs(x - 15) + std::abs(y - 16) + std::abs(z - 14);
        if (distance < r) {
          ++strictly;
          EXPECT_TRUE(octree.contains({x, y, z})) << x << " " << y << " " << z;
        } else if (distance == r) {
          ++boundary;
        } else {
          EXPECT_FALSE(octree.contains({x, y, z})) << x << " " << y << " " << z;
        }
      }
  EXPECT_EQ(strictly, 17U * (2 * 8 * 8 + 2 * 8 + 3) / 3);
  EXPECT_GT(octree.voxel_count(), strictly);
  EXPECT_LT(octree.voxel_count(), strictly + boundary);
}

TEST(Voxelise, TwoSolidsThatShareAFaceShareNoVoxelAndLoseNone) {
  // A box cut along a plane through voxel centres and lattice corners: both parts have the same triangles in
  // the shared face.
  brep::Triangles lower = box({2, 2, 2}, {12, 12, 12});
  lower.points_mm[5] = {12, 2, 5};
  lower.points_mm[7] = {12, 12, 5};
  brep::Triangles upper = box({2, 2, 2}, {12, 12, 12});
  upper.points_mm[0] = {2, 2, 12};
  upper.points_mm[2] = {2, 12, 12};
  upper.points_mm[1] = {12, 2, 5};
  upper.points_mm[3] = {12, 12, 5};
  // The upper part is a wedge: its left side has no height.
  upper.points_mm[4] = {2, 2, 12.75};
  upper.points_mm[6] = {2, 12, 12.75};
  const voxel::Universe universe = unit_universe(4);
  const voxel::Octree low = voxelise(universe, brep::linked(lower));
  const voxel::Octree up = voxelise(universe, brep::linked(upper));
  brep::Triangles whole = box({2, 2, 2}, {12, 12, 12});
  whole.points_mm[4] = upper.points_mm[4];
  whole.points_mm[6] = upper.points_mm[6];
  const voxel::Octree all = voxelise(universe, brep::linked(whole));
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const glm::ivec3 v(x, y, z);
        EXPECT_FALSE(low.contains(v) && up.contains(v)) << x << " " << y << " " << z;
        EXPECT_EQ(low.contains(v) || up.contains(v), all.contains(v)) << x << " " << y << " " << z;
      }
  EXPECT_GT(low.voxel_count(), 500U);
  EXPECT_GT(up.voxel_count(), 250U);
}

TEST(Voxelise, AgreesWithTheWindingNumberOnEveryVoxelInAnyPoseAndSize) {
  for (const int depth : {2, 3, 4, 5}) {
    voxel::Universe universe;
    universe.depth = depth;
    const double h = 32.0 / universe.side();
    universe.lps_from_voxel = glm::rotate(glm::dmat4(1.0), 0.3 * depth, glm::dvec3(1, -2, 0.5)) *
                              glm::scale(glm::dmat4(1.0), glm::dvec3(h, h, 0.8 * h));
    const glm::dvec3 centre = universe.lattice().lps_mm(glm::dvec3(0.5 * (universe.side() - 1)));
    const brep::Triangles solid = ball(centre + 0.37, 10.3, 2);
    const voxel::Octree octree = voxelise(universe, brep::linked(solid));
    EXPECT_EQ(first_unlike_winding(octree, solid), std::nullopt) << "depth " << depth;
    EXPECT_GT(octree.voxel_count(), 0U);
  }
}

TEST(Voxelise, TheComparisonWithTheWindingNumberSeesAMovedVertex) {
  brep::Triangles solid = ball({15.3, 15.1, 15.2}, 10.3, 1);
  const voxel::Octree octree = voxelise(unit_universe(5), brep::linked(solid));
  ASSERT_EQ(first_unlike_winding(octree, solid), std::nullopt);
  solid.points_mm[0].x -= 3.0;
  EXPECT_NE(first_unlike_winding(octree, solid), std::nullopt);
}

TEST(Voxelise, ABallsVoxelsTakeItsVolume) {
  const brep::Triangles solid = ball({63.2, 63.7, 64.1}, 50.0, 5);
  const voxel::Octree octree = voxelise(unit_universe(7), brep::linked(solid));
  // Three times the standard error 0.3 sqrt(S) of a count of voxel centres on curved boundary.
  const double tolerance = 3.0 * 0.3 * std::sqrt(4.0 * std::numbers::pi) * 50.0;
  EXPECT_NEAR(static_cast<double>(octree.voxel_count()), tests::volume_mm3(solid), tolerance);
}

TEST(Voxelise, ACavityStaysEmpty) {
  const brep::Triangles shell = together(box({1.5, 1.5, 1.5}, {13.5, 13.5, 13.5}),
                                         inside_out(box({4.5, 4.5, 4.5}, {10.5, 10.5, 10.5})));
  const voxel::Octree octree = voxelise(unit_universe(4), brep::linked(shell));
  EXPECT_EQ(octree.voxel_count(), 12U * 12U * 12U - 6U * 6U * 6U);
  EXPECT_FALSE(octree.contains({7, 7, 7}));
}

TEST(Voxelise, ASolidLargerThanTheUniverseIsCutByIt) {
  EXPECT_EQ(voxelise(unit_universe(4), brep::linked(box({-100, -100, -100}, {100, 100, 100}))).voxel_count(),
            4096U);
  EXPECT_EQ(voxelise(unit_universe(3), brep::linked(box({-100, -100, -100}, {100, 100, 100}))).voxel_count(),
            512U);
  EXPECT_EQ(voxelise(unit_universe(4), brep::linked(box({4.5, -100, -1e6}, {1e6, 7.5, 3.5}))).voxel_count(),
            11U * 8U * 4U);
  EXPECT_TRUE(voxelise(unit_universe(4), brep::linked(box({20, 20, 20}, {30, 30, 30}))).is_empty());
}

TEST(Voxelise, AnOpenMeshIsRefusedAndTheMessageSaysWhere) {
  brep::Triangles open = box({1, 1, 1}, {5, 5, 5});
  open.faces.pop_back();
  try {
    voxelise(unit_universe(4), brep::linked(open));
    FAIL() << "an open mesh was accepted";
  } catch (const voxel::Error& error) {
    EXPECT_NE(std::string(error.what()).find("open at ("), std::string::npos) << error.what();
  }
}

TEST(Voxelise, AnEmptyMeshIsAnEmptyOctree) {
  EXPECT_TRUE(voxelise(unit_universe(4), brep::Linked()).is_empty());
}

TEST(Voxelise, GivesTheSameOctreeOnOneThreadAndMany) {
  const brep::Linked solid = brep::linked(ball({31.2, 30.7, 33.1}, 25.0, 4));
  const voxel::Octree many = voxelise(unit_universe(6), solid);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(voxelise(unit_universe(6), solid) == many);
}

}  // namespace
}  // namespace octotomy::convert
