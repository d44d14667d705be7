// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/local_thickness.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/error.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

/// A convex body's volume, area and integral of mean curvature.
struct Steiner {
  double volume, area, bend;
  double grown(double r) const { return volume + area * r + bend * r * r + 4.0 / 3.0 * pi * r * r * r; }
};

Steiner box_of(const glm::dvec3& e) {
  return {e.x * e.y * e.z, 2 * (e.x * e.y + e.y * e.z + e.z * e.x), pi * (e.x + e.y + e.z)};
}
Steiner rod_of(double radius, double length) {
  return {pi * radius * radius * length, 2 * pi * radius * (radius + length), pi * (length + pi * radius)};
}
Steiner cone_of(double radius, double height) {
  const double slope = std::hypot(radius, height), tip = std::atan2(radius, height);
  // The side bends by cos / (2 r) a unit of area; the rim turns from straight down to the side's normal.
  return {pi * radius * radius * height / 3, pi * radius * (radius + slope),
          pi * slope * std::cos(tip) + pi * radius * (0.5 * pi + tip)};
}

/// The mean over a convex body of the largest ball's diameter: the points that balls of radius r cover are
/// those within r of what is left r inside, and the mean of a quantity is the integral of how much exceeds it.
template <typename Inside>
double mean_mm(double largest_mm, const Inside& inside) {
  constexpr int steps = 2000;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double r = 0.5 * largest_mm * (i + 0.5) / steps;
    sum += inside(r).grown(r);
  }
  return largest_mm / steps * sum / inside(0.0).volume;
}

Triangles turned(double radius, double height, int around, bool is_cone) {
  Triangles t;
  const auto n = static_cast<std::uint32_t>(around);
  for (const double z : {0.0, height})
    for (int i = 0; i < around && (z == 0.0 || !is_cone); ++i)
      t.points_mm.emplace_back(radius * std::cos(2 * pi * i / around), radius * std::sin(2 * pi * i / around),
                               z);
  const auto low = static_cast<std::uint32_t>(t.points_mm.size()), high = low + 1;
  t.points_mm.emplace_back(0, 0, 0);
  t.points_mm.emplace_back(0, 0, height);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    t.faces.push_back({low, j, i});
    if (is_cone) {
      t.faces.push_back({i, j, high});
    } else {
      t.faces.insert(t.faces.end(), {{high, n + i, n + j}, {i, j, n + j}, {i, n + j, n + i}});
    }
  }
  return t;
}

void expect_mean(const LocalThickness& found, double truth_mm, double most_half_width_share) {
  EXPECT_NEAR(found.mean_mm, truth_mm, found.mean_half_width_mm);
  EXPECT_LT(found.mean_half_width_mm, most_half_width_share * truth_mm);
}

TEST(LocalThickness, ABoxesMeanIsThatOfSteinersFormulaAndItsLargestItsShortestEdge) {
  const LocalThickness found = local_thickness(solid_of(shapes::box({0, 0, 0}, {20, 30, 40})));
  expect_mean(found, mean_mm(20, [](double r) { return box_of(glm::dvec3(20, 30, 40) - 2 * r); }), 0.03);
  EXPECT_NEAR(found.largest_mm, 20.0, 1e-6);
  ASSERT_TRUE(found.thinnest_wall);
  // A ball counts as touching within 2.5 % of its radius.
  EXPECT_NEAR(found.surface[*found.thinnest_wall].thickness_mm, 20.0, 0.25);
}

TEST(LocalThickness, APlatesIsItsOwn) {
  const LocalThickness found = local_thickness(solid_of(shapes::box({0, 0, 0}, {40, 30, 5})));
  expect_mean(found, mean_mm(5, [](double r) { return box_of(glm::dvec3(40, 30, 5) - 2 * r); }), 0.03);
  EXPECT_NEAR(found.median_mm, 5.0, 0.005);
  EXPECT_NEAR(found.largest_mm, 5.0, 1e-6);
  ASSERT_TRUE(found.thinnest_wall);
  EXPECT_NEAR(found.surface[*found.thinnest_wall].thickness_mm, 5.0, 0.07);
}

TEST(LocalThickness, AShellsIsTheDifferenceOfItsRadiiEverywhere) {
  const Solid shell = solid_of(shapes::together(shapes::sphere({0, 0, 0}, 10, 5),
                                                shapes::inside_out(shapes::sphere({0, 0, 0}, 8, 5))));
  const LocalThickness found = local_thickness(shell);
  EXPECT_NEAR(found.mean_mm, 2.0, 0.01);
  EXPECT_LT(found.deviation_mm, 0.01);
  EXPECT_NEAR(found.surface[found.thinnest_wall.value()].thickness_mm, 2.0, 0.03);
}

TEST(LocalThickness, ABallsIsItsDiameter) {
  const LocalThickness found = local_thickness(solid_of(shapes::sphere({1, 2, 3}, 10, 5)));
  EXPECT_NEAR(found.mean_mm, 20.0, 0.1);
  EXPECT_LT(found.deviation_mm, 0.1);
  EXPECT_NEAR(found.surface[found.thinnest_wall.value()].thickness_mm, 20.0, 0.2);
  // Facets make balls at single points smaller; the largest that holds a point is what counts.
  for (const LocalThicknessAt& at : found.surface) EXPECT_TRUE(at.is_wall);
}

TEST(LocalThickness, ARodsAndAConesFollowSteinersFormula) {
  const LocalThickness rod = local_thickness(solid_of(turned(5, 60, 256, false)));
  expect_mean(rod, mean_mm(10, [](double r) { return rod_of(5 - r, 60 - 2 * r); }), 0.03);
  EXPECT_NEAR(rod.surface[rod.thinnest_wall.value()].thickness_mm, 10.0, 0.2);

  const LocalThickness cone = local_thickness(solid_of(turned(10, 30, 256, true)));
  const double largest = 2 * 10 * 30 / (10 + std::hypot(10, 30));
  expect_mean(cone,
              mean_mm(largest,
                      [&](double r) {
                        const double left = 1 - 2 * r / largest;
                        return cone_of(10 * left, 30 * left);
                      }),
              0.03);
  EXPECT_NEAR(cone.largest_mm, largest, 0.003 * largest);
  // The sides enclose 37 degrees, too many for a wall.
  EXPECT_FALSE(cone.thinnest_wall);
}

TEST(LocalThickness, TheThinWallOfTwoIsFound) {
  // A box with a cavity 1 mm below one face and 3 mm and more below the others.
  const Solid hollow = solid_of(shapes::together(shapes::box({0, 0, 0}, {20, 20, 20}),
                                                 shapes::inside_out(shapes::box({3, 4, 5}, {16, 16, 19}))));
  const LocalThickness found = local_thickness(hollow);
  const LocalThicknessAt& thinnest = found.surface[found.thinnest_wall.value()];
  EXPECT_NEAR(thinnest.thickness_mm, 1.0, 0.02);
  EXPECT_GE(thinnest.point.p_mm.z, 19.0 - 1e-9);
}

TEST(LocalThickness, TheThinnestWallAloneIsThatOfAllBalls) {
  Triangles two = shapes::box({0, 0, 0}, {20, 30, 2});
  const auto shift = static_cast<std::uint32_t>(two.points_mm.size());
  const Triangles block = shapes::box({0, 0, 10}, {20, 30, 16});
  two.points_mm.insert(two.points_mm.end(), block.points_mm.begin(), block.points_mm.end());
  for (const auto& face : block.faces)
    two.faces.push_back({face[0] + shift, face[1] + shift, face[2] + shift});
  for (const Triangles& shape : {two, shapes::box({0, 0, 0}, {20, 30, 40})}) {
    const Solid solid = solid_of(shape);
    const LocalThickness all = local_thickness(solid);
    const ThinnestWall alone = thinnest_wall(solid);
    ASSERT_TRUE(all.thinnest_wall);
    ASSERT_TRUE(alone.at);
    EXPECT_TRUE(alone.at->is_wall);
    EXPECT_EQ(alone.reach_mm, all.reach_mm);
    EXPECT_LE(alone.at->thickness_mm, all.surface[*all.thinnest_wall].thickness_mm);
    EXPECT_NEAR(alone.at->thickness_mm / all.surface[*all.thinnest_wall].thickness_mm, 1.0, 0.01);
  }
  // A ball's second place lies opposite everywhere; a thin prism's tip is no wall.
  EXPECT_NEAR(thinnest_wall(solid_of(shapes::sphere({0, 0, 0}, 5.0, 4))).at->thickness_mm, 10.0, 0.3);
  EXPECT_THROW(thinnest_wall(Solid()), std::invalid_argument);
}

TEST(LocalThickness, IsTheSameOnOneThread) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 10, 3));
  const LocalThickness many = local_thickness(ball, {.samples = 2000});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LocalThickness single = local_thickness(ball, {.samples = 2000});
  EXPECT_EQ(many.mean_mm, single.mean_mm);
  EXPECT_EQ(many.deviation_mm, single.deviation_mm);
  EXPECT_EQ(many.mean_half_width_mm, single.mean_half_width_mm);
}

TEST(LocalThickness, RefusesWhatItCannotDoAndStops) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 1, 1));
  EXPECT_THROW(local_thickness(Solid()), std::invalid_argument);
  EXPECT_THROW(local_thickness(ball, {.samples = 3}), std::invalid_argument);
  EXPECT_THROW(local_thickness(ball, {.wall_angle_deg = 90}), std::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(local_thickness(ball, {.stop = stop.get_token()}), Stopped);
}

}  // namespace
}  // namespace octotomy::brep
