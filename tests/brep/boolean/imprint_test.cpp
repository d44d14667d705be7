// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/imprint.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <set>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;

std::set<Corners> corners_of(const Triangles& surface) {
  std::set<Corners> all;
  for (const auto& face : surface.faces) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p = surface.points_mm[face[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::sort(corners.begin(), corners.end());
    all.insert(corners);
  }
  return all;
}

std::size_t common_count(const Solid& a, const Solid& b) {
  const std::set<Corners> of_a = corners_of(a.triangles());
  std::size_t count = 0;
  for (const Corners& corners : corners_of(b.triangles())) count += of_a.count(corners);
  return count;
}

const glm::dmat4 turned_pose = glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(31, -12, 77)), 1.1,
                                           glm::normalize(glm::dvec3(1, 2, -0.5)));

TEST(Imprint, APieceOfABallHasTheBallsTrianglesInAnyPose) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 20, 3));
  const Solid piece =
      boolean(ball, Operation::Intersection, solid_of(shapes::box({1, -30, -30}, {30, 7, 30}))).solid;
  const Solid a = moved(ball, turned_pose), b = moved(piece, turned_pose);
  const std::optional<Imprinted> both = imprinted(a, b);
  ASSERT_TRUE(both);
  EXPECT_LT(both->moved_mm, 1e-12);
  EXPECT_NEAR(volume_mm3(both->a), volume_mm3(ball), 1e-8);
  EXPECT_NEAR(volume_mm3(both->b), volume_mm3(piece), 1e-8);
  // The common triangles are all but those of the cut.
  EXPECT_GT(common_count(both->a, both->b), b.triangles().faces.size() * 3 / 4);
  const BooleanResult rest = boolean(a, Operation::Difference, b);
  EXPECT_NEAR(volume_mm3(rest.solid), volume_mm3(ball) - volume_mm3(piece), 1e-8);
  const Health found = health(rest.solid.triangles());
  EXPECT_EQ(found.self_intersections + found.degenerate_faces, 0u);
}

TEST(Imprint, SidesThatCrossInAFaceDivideBoth) {
  const Solid a = moved(solid_of(shapes::box({0, 0, 0}, {4, 4, 4})), turned_pose),
              b = moved(solid_of(shapes::box({1, 1, 4}, {6, 3, 6})), turned_pose);
  const std::optional<Imprinted> both = imprinted(a, b);
  ASSERT_TRUE(both);
  EXPECT_GE(common_count(both->a, both->b), 2u);
  EXPECT_NEAR(volume_mm3(both->a), 64, 1e-10);
  EXPECT_NEAR(volume_mm3(both->b), 20, 1e-10);
}

TEST(Imprint, SolidsWithoutACommonPlaneHaveNone) {
  EXPECT_FALSE(
      imprinted(solid_of(shapes::sphere({0, 0, 0}, 3, 2)), solid_of(shapes::box({0, 0, 0}, {1, 2, 5}))));
}

}  // namespace
}  // namespace octotomy::brep
