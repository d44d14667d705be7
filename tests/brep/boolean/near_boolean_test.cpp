// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/near_boolean.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

constexpr Wanted all_results = {true, true, true, true};

NearBoolean near(const Triangles& a, const Triangles& b, const Wanted& wanted = all_results) {
  return near_boolean(trusted_solid(a, Proof::Connection), trusted_solid(b, Proof::Connection), wanted);
}

TEST(NearBoolean, HasTheVolumesOfWholeCorefinementAndIsSolid) {
  const Triangles a = shapes::sphere({0.1, 0.2, 0.3}, 3, 4), b = shapes::sphere({2.5, 0.5, 0.25}, 2, 4);
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  const Corefined whole = corefine(mesh_of(a), mesh_of(b), all_results);
  for (std::size_t r = 0; r < all_results.size(); ++r) {
    ASSERT_TRUE(sewn.results[r] && whole.results[r]) << r;
    EXPECT_NEAR(size_of(*sewn.results[r]).volume_mm3, size_of(*whole.results[r]).volume_mm3, 1e-11) << r;
    EXPECT_NEAR(*sewn.volumes_mm3[r], size_of(*sewn.results[r]).volume_mm3, 1e-11) << r;
    EXPECT_EQ(sewn.results[r]->faces.size(), whole.results[r]->faces.size()) << r;
    EXPECT_TRUE(health(*sewn.results[r]).solid()) << health(*sewn.results[r]).findings.front();
  }
}

TEST(NearBoolean, PartsThatNothingTouchesAreToldByTheRayAlone) {
  // One ball is cut, one is completely inside, one is far away.
  const Triangles a =
      shapes::together(shapes::together(shapes::sphere({0, 0, 0}, 5, 4), shapes::sphere({30, 0, 0}, 2, 2)),
                       shapes::sphere({0.5, 40, 0}, 1, 2));
  const Triangles b = shapes::together(shapes::sphere({4, 0.1, 0.2}, 4, 4), shapes::sphere({30, 0, 0}, 6, 3));
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  const double a_mm3 = size_of(a).volume_mm3, b_mm3 = size_of(b).volume_mm3;
  EXPECT_NEAR(*sewn.volumes_mm3[of_union] + *sewn.volumes_mm3[of_intersection], a_mm3 + b_mm3, 1e-10);
  // The small ball at x = 30 lies completely in the common part.
  EXPECT_GT(*sewn.volumes_mm3[of_intersection], size_of(shapes::sphere({30, 0, 0}, 2, 2)).volume_mm3 + 1.0);
  EXPECT_TRUE(health(*sewn.results[of_b_minus_a]).solid());
}

TEST(NearBoolean, GivesUpWithTheReasonWhereItIsNoGain) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_NE(near(box, shapes::box({0.5, 0, 0}, {1.5, 1, 1})).obstacle.find("half"), std::string::npos);
}

/// Whether the volumes of all results add up.
void expect_to_add_up(const NearBoolean& sewn, const Triangles& a, const Triangles& b) {
  const double a_mm3 = size_of(a).volume_mm3, b_mm3 = size_of(b).volume_mm3;
  EXPECT_NEAR(*sewn.volumes_mm3[of_union] + *sewn.volumes_mm3[of_intersection], a_mm3 + b_mm3, 1e-9 * b_mm3);
  EXPECT_NEAR(*sewn.volumes_mm3[of_a_minus_b] + *sewn.volumes_mm3[of_intersection], a_mm3, 1e-9 * a_mm3);
  EXPECT_NEAR(*sewn.volumes_mm3[of_b_minus_a] + *sewn.volumes_mm3[of_intersection], b_mm3, 1e-9 * b_mm3);
}

TEST(NearBoolean, TrianglesWithoutAreaAtTheBorderAreTakenOut) {
  Triangles a = shapes::sphere({0.125, 0.25, 0.375}, 3, 4);
  // On a lattice of 2^-20 the middle of a side is exact, so that the triangle over it has no area.
  for (glm::dvec3& p : a.points_mm) p = glm::round(p * 0x1p20) * 0x1p-20;
  const std::size_t faces = a.faces.size();
  for (std::size_t f = 0; f < faces; f += 3) {
    const auto [p, q, r] = a.faces[f];
    const auto m = static_cast<std::uint32_t>(a.points_mm.size());
    a.points_mm.push_back(0.5 * (a.points_mm[p] + a.points_mm[q]));
    a.faces[f] = {p, m, r};
    a.faces.push_back({m, q, r});
    a.faces.push_back({p, q, m});
  }
  const Triangles b = shapes::sphere({2.5, 0.5, 0.25}, 2, 4);
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  EXPECT_GT(sewn.flat, 0u);
  expect_to_add_up(sewn, a, b);
}

TEST(NearBoolean, PartsThatOnlyTouchAreKeptWhereOthersAreCut) {
  Triangles ball = shapes::sphere({0, 0, 0}, 5, 3);
  std::size_t top = 0;
  for (std::size_t v = 0; v < ball.points_mm.size(); ++v)
    if (ball.points_mm[v].z > ball.points_mm[top].z) top = v;
  ball.points_mm[top] = {0.25, 0.5, 5.5};
  const Triangles a = shapes::together(ball, shapes::sphere({20.125, 0.3, 5.7}, 4, 3));
  const Triangles b =
      shapes::together(shapes::box({-9, -9, 5.5}, {39, 9, 12}), shapes::sphere({60, 0, 0}, 8, 3));
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  expect_to_add_up(sewn, a, b);
  EXPECT_LT(*sewn.volumes_mm3[of_intersection], 0.6 * size_of(shapes::sphere({0, 0, 0}, 4, 3)).volume_mm3);
  EXPECT_TRUE(health(*sewn.results[of_intersection]).solid());
}

TEST(NearBoolean, GivesUpWhereSurfacesTouchInAPointOnly) {
  Triangles a = shapes::sphere({0, 0, 0}, 5, 3);
  // Its highest point is put onto the box's face exactly.
  std::size_t top = 0;
  for (std::size_t v = 0; v < a.points_mm.size(); ++v)
    if (a.points_mm[v].z > a.points_mm[top].z) top = v;
  a.points_mm[top] = {0.25, 0.5, 5.5};
  Triangles b = shapes::box({-9, -9, 5.5}, {9, 9, 12});
  // Large enough for the touch to be far from everything else.
  const Triangles fine = shapes::together(b, shapes::sphere({60, 0, 0}, 8, 3));
  EXPECT_NE(near(a, fine).obstacle.find("touch"), std::string::npos) << near(a, fine).obstacle;
}

}  // namespace
}  // namespace octotomy::brep
