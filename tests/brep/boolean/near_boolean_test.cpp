// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/near_boolean.h"

#include <gtest/gtest.h>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

constexpr Wanted all = {true, true, true, true};

NearBoolean near(const Triangles& a, const Triangles& b, const Wanted& wanted = all) {
  return near_boolean(trusted_solid(a, Proof::Connection), trusted_solid(b, Proof::Connection), wanted);
}

TEST(NearBoolean, HasTheVolumesOfWholeCorefinementAndIsSolid) {
  const Triangles a = shapes::sphere({0.1, 0.2, 0.3}, 3, 4), b = shapes::sphere({2.5, 0.5, 0.25}, 2, 4);
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  const Corefined whole = corefine(mesh_of(a), mesh_of(b), all);
  for (std::size_t r = 0; r < all.size(); ++r) {
    ASSERT_TRUE(sewn.results[r] && whole.results[r]) << r;
    EXPECT_NEAR(size_of(*sewn.results[r]).volume_mm3, size_of(*whole.results[r]).volume_mm3, 1e-11) << r;
    EXPECT_NEAR(*sewn.volumes_mm3[r], size_of(*sewn.results[r]).volume_mm3, 1e-11) << r;
    EXPECT_EQ(sewn.results[r]->faces.size(), whole.results[r]->faces.size()) << r;
    EXPECT_TRUE(health(*sewn.results[r]).solid()) << health(*sewn.results[r]).findings.front();
  }
}

TEST(NearBoolean, PartsThatNothingTouchesAreToldByTheRayAlone) {
  // One ball cuts, one is swallowed, one is far off.
  const Triangles a =
      shapes::together(shapes::together(shapes::sphere({0, 0, 0}, 5, 4), shapes::sphere({30, 0, 0}, 2, 2)),
                       shapes::sphere({0.5, 40, 0}, 1, 2));
  const Triangles b = shapes::together(shapes::sphere({4, 0.1, 0.2}, 4, 4), shapes::sphere({30, 0, 0}, 6, 3));
  const NearBoolean sewn = near(a, b);
  ASSERT_EQ(sewn.obstacle, "");
  const double a_mm3 = size_of(a).volume_mm3, b_mm3 = size_of(b).volume_mm3;
  EXPECT_NEAR(*sewn.volumes_mm3[of_union] + *sewn.volumes_mm3[of_intersection], a_mm3 + b_mm3, 1e-10);
  // The small ball at x = 30 is wholly in common.
  EXPECT_GT(*sewn.volumes_mm3[of_intersection], size_of(shapes::sphere({30, 0, 0}, 2, 2)).volume_mm3 + 1.0);
  EXPECT_TRUE(health(*sewn.results[of_b_minus_a]).solid());
}

TEST(NearBoolean, GivesUpWithTheReasonWhereItIsNoGain) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_NE(near(box, shapes::box({0.5, 0, 0}, {1.5, 1, 1})).obstacle.find("half"), std::string::npos);
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
