// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/dihedral_angle.h"

#include <gtest/gtest.h>
#include <numbers>

#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// The sum over edges of length times angle.
double bend(const Triangles& surface) {
  const Linked all = linked(surface);
  const auto& p = all.triangles.points_mm;
  const auto normal = [&](std::uint32_t side) {
    const auto& [a, b, c] = all.triangles.faces[side / 3];
    return glm::cross(p[b] - p[a], p[c] - p[a]);
  };
  double sum = 0.0;
  for (std::uint32_t side = 0; side < all.opposite.size(); ++side) {
    if (!all.is_inner_edge(side)) continue;
    const glm::dvec3 along = p[all.to(side)] - p[all.from(side)];
    sum += glm::length(along) * dihedral_angle(normal(side), normal(all.opposite[side]), along);
  }
  return sum;
}

TEST(DihedralAngle, IsARightAngleAlongTheEdgesOfABoxAndNoneAcrossItsFaces) {
  const Triangles box = shapes::box({-1, 2, -3}, {2, 4, 1});
  const double edges_mm = 4.0 * (3 + 2 + 4);
  EXPECT_NEAR(bend(box), 0.5 * std::numbers::pi * edges_mm, 1e-12 * edges_mm);
  EXPECT_NEAR(bend(shapes::inside_out(box)), -0.5 * std::numbers::pi * edges_mm, 1e-12 * edges_mm);
}

TEST(DihedralAngle, IsExactWhereItIsSmallWhateverTheNormalsLengths) {
  for (double angle = 1e-15; angle < 3.1; angle *= 3.0) {
    const glm::dvec3 along(0, 0, 2), flat(0, 1e-3, 0), bent(1e4 * std::sin(angle), 1e4 * std::cos(angle), 0);
    EXPECT_NEAR(dihedral_angle(flat, bent, along), -angle, 1e-15 * angle);
    EXPECT_NEAR(dihedral_angle(bent, flat, along), angle, 1e-15 * angle);
  }
}

TEST(DihedralAngle, IsNoneBesideATriangleWithoutArea) {
  for (const glm::dvec3& normal : {glm::dvec3(1, 2, 3), glm::dvec3(-1, -2, -3), glm::dvec3(0)})
    EXPECT_EQ(dihedral_angle(normal, glm::dvec3(0), {0, 0, 1}), 0.0);
}

}  // namespace
}  // namespace octotomy::brep
