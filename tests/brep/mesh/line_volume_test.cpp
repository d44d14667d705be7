// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/line_volume.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/measure.h"
#include "tests/brep/bad_meshes.h"

namespace octotomy::brep {
namespace {

using shapes::box;
using shapes::inside_out;
using shapes::sphere;
using shapes::together;
using shapes::torus;
using shapes::without;

TEST(LineVolume, OfABallComesToTheTrianglesOwnAsLinesGrow) {
  const Triangles ball = sphere({1, 2, 3}, 5, 4);
  const double truth = size_of(ball).volume_mm3;
  double last = 1.0;
  for (const std::size_t lines : {1u << 10, 1u << 14, 1u << 18}) {
    const double error = std::abs(line_volumes(ball, {}, lines).all.a_mm3 / truth - 1.0);
    EXPECT_LT(error, last);
    last = error;
  }
  EXPECT_LT(last, 1e-5);
}

TEST(LineVolume, TheSameSurfaceTwiceHasItsOwnVolumeInCommon) {
  const Triangles ring = torus(10, 3, 60, 30);
  const LineVolumes volumes = line_volumes(ring, ring, 1u << 14);
  EXPECT_EQ(volumes.all.common_mm3, volumes.all.a_mm3);
  EXPECT_EQ(volumes.all.b_mm3, volumes.all.a_mm3);
  EXPECT_EQ(volumes.open_lines, 0u);
}

TEST(LineVolume, BoxesThatOverlapShareTheirOverlapWhicheverWayTheyFaceAndTheLensOfBallsItsClosedForm) {
  const Triangles a = box({0, 0, 0}, {10, 10, 10}), b = inside_out(box({5, 5, 5}, {15, 15, 15}));
  const LineVolumes boxes = line_volumes(a, b, 1u << 18);
  EXPECT_NEAR(boxes.all.common_mm3, 125.0, 0.5);
  EXPECT_NEAR(boxes.all.b_mm3, 1000.0, 2.0);
  const LineVolumes balls = line_volumes(sphere({0, 0, 0}, 20, 6), sphere({0, 2, 0}, 20, 6));
  const double dice = 2.0 * balls.all.common_mm3 / (balls.all.a_mm3 + balls.all.b_mm3);
  EXPECT_NEAR(dice, 1.0 - 0.075 + 8.0 / (16 * 8000.0), 2e-4);
  const auto& [even, odd] = balls.halves;
  EXPECT_LT(std::abs(even.common_mm3 / odd.common_mm3 - 1.0), 1e-4);
}

TEST(LineVolume, ShellsThatCrossCountOnceACavityNotAtAll) {
  const Triangles ball = sphere({0, 0, 0}, 5, 4);
  EXPECT_NEAR(line_volumes(together(ball, ball), {}, 1u << 16).all.a_mm3, size_of(ball).volume_mm3, 0.05);
  const Triangles hollow = together(ball, inside_out(sphere({0, 0, 0}, 3, 4)));
  EXPECT_NEAR(line_volumes(hollow, {}, 1u << 16).all.a_mm3, size_of(hollow).volume_mm3, 0.05);
}

TEST(LineVolume, SurfacesOfVeryManyLayersArePassedByFewerLines) {
  Triangles shells;
  for (int i = 0; i < 400; ++i) shells = together(shells, sphere({0, 0, 0}, 10.0 + 0.01 * i, 2));
  const LineVolumes volumes = line_volumes(shells, {});
  EXPECT_GT(volumes.lines, 50'000u);
  EXPECT_LT(volumes.lines * 2 * 400, 100'000'000u);
  EXPECT_NEAR(volumes.all.a_mm3 / size_of(sphere({0, 0, 0}, 13.99, 2)).volume_mm3, 1.0, 1e-4);
}

TEST(LineVolume, LinesThroughAHoleAreToldAndLeftOut) {
  const LineVolumes open =
      line_volumes(without(box({0, 0, 0}, {10, 10, 10}), {8, 9}), {}, 1u << 12);  // x = 0
  EXPECT_EQ(open.open_lines, open.lines);
  EXPECT_EQ(open.all.a_mm3, 0.0);
  EXPECT_EQ(line_volumes({}, {}).lines, 0u);
}

TEST(LineVolume, HasTheSameBitsOnOneThread) {
  const Triangles a = torus(10, 3, 60, 30), b = sphere({8, 0, 0}, 4, 4);
  const double many = line_volumes(a, b, 1u << 16).all.common_mm3;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(line_volumes(a, b, 1u << 16).all.common_mm3, many);
}

}  // namespace
}  // namespace octotomy::brep
