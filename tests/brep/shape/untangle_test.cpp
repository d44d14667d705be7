// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/untangle.h"

#include <gtest/gtest.h>
#include <numbers>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(Untangle, ADentThatComesOutOfTheOtherSideIsTakenBack) {
  Triangles ball = shapes::sphere({0, 0, 0}, 5, 3);
  ball.points_mm[0] *= -1.2;
  const Health before = health(ball);
  ASSERT_GT(before.self_intersections, 0u);
  const Untangled done = untangle(mesh_of(ball));
  ASSERT_TRUE(done.is_done);
  EXPECT_TRUE(health(done.surface).solid());
  EXPECT_FALSE(done.removed.empty());
  EXPECT_GT(done.added, 0u);
  EXPECT_NEAR(size_of(done.surface).volume_mm3, 4.0 / 3.0 * std::numbers::pi * 125, 20.0);
}

TEST(Untangle, WhatDoesNotIntersectStays) {
  const Triangles ball = shapes::sphere({0, 0, 0}, 5, 2);
  const Untangled done = untangle(mesh_of(ball));
  EXPECT_TRUE(done.is_done);
  EXPECT_TRUE(done.removed.empty());
  EXPECT_EQ(done.added, 0u);
  EXPECT_EQ(size_of(done.surface).volume_mm3, size_of(ball).volume_mm3);
}

}  // namespace
}  // namespace octotomy::brep
