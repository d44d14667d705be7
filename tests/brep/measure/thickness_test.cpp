// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/thickness.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/error.h"
#include "brep/mesh/sample_surface.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::vector<SurfacePoint> points_on(const Mesh& mesh, double spacing_mm) {
  const SurfaceSamples samples = sample_surface(mesh, spacing_mm);
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < samples.points_mm.size(); ++i)
    points.push_back({samples.points_mm[i], samples.normals[i]});
  return points;
}

TEST(Thickness, APlatesIsItsOwnByRayAndByBallAwayFromItsRim) {
  const Solid plate = solid_of(shapes::box({0, 0, 0}, {40, 30, 3}));
  const auto points = points_on(plate, 1.0);
  const auto found = thickness(plate, points);
  int inner = 0, rim = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3& p = points[i].p_mm;
    if (std::abs(points[i].normal.z) < 0.5) continue;
    EXPECT_NEAR(found[i].ray_mm, 3.0, 1e-6);
    const double to_rim = std::min(std::min(p.x, 40 - p.x), std::min(p.y, 30 - p.y));
    // A ball that touches the plate's face cannot be larger than twice the way to its side.
    EXPECT_NEAR(found[i].ball_mm, std::min(3.0, 2.0 * to_rim), 1e-6) << p.x << " " << p.y;
    ++(to_rim > 1.5 ? inner : rim);
  }
  EXPECT_GT(inner, 1000);
  EXPECT_GT(rim, 100);
}

TEST(Thickness, AShellsIsTheDifferenceOfItsRadii) {
  const Solid shell = solid_of(shapes::together(shapes::sphere({0, 0, 0}, 10, 5),
                                                shapes::inside_out(shapes::sphere({0, 0, 0}, 8, 5))));
  const auto points = points_on(shell, 3.0);
  for (const Thickness& t : thickness(shell, points)) {
    EXPECT_NEAR(t.ray_mm, 2.0, 0.02);
    EXPECT_NEAR(t.ball_mm, 2.0, 0.02);
  }
}

TEST(Thickness, InAWedgeTheBallIsThinnerThanTheRay) {
  // Two sides that meet at 30 degrees along z: a ball that touches both at d from the edge has diameter
  // 2 d tan 15.
  const double slope = std::tan(std::numbers::pi / 6);
  const Triangles wedge{
      {{0, 0, -50}, {20, 0, -50}, {20, 20 * slope, -50}, {0, 0, 50}, {20, 0, 50}, {20, 20 * slope, 50}},
      {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}};
  const std::vector<SurfacePoint> points = {{{5, 0, 0}, {0, -1, 0}}, {{10, 0, 0}, {0, -1, 0}}};
  const auto found = thickness(solid_of(wedge), points);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(found[i].ray_mm, points[i].p_mm.x * slope, 1e-6);
    EXPECT_NEAR(found[i].ball_mm, 2 * points[i].p_mm.x * std::tan(std::numbers::pi / 12), 1e-6);
  }
}

TEST(Thickness, IsTheSameOnOneThread) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 10, 3));
  const auto points = points_on(ball, 1.0);
  const auto many = thickness(ball, points);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = thickness(ball, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(many[i].ray_mm, single[i].ray_mm);
    EXPECT_EQ(many[i].ball_mm, single[i].ball_mm);
  }
}

TEST(Thickness, RefusesWhatHasNoOtherSide) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 1, 1));
  EXPECT_THROW(thickness(ball, {{{5, 0, 0}, {-1, 0, 0}}}), std::invalid_argument);
  EXPECT_THROW(thickness(Solid(), {}), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(thickness(ball, points_on(ball, 1.0), {30.0, {}, stop.get_token()}), Stopped);
}

}  // namespace
}  // namespace octotomy::brep
