// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/offset.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

Solid solid_ball(double radius) {
  return solid_of(shapes::sphere({0.1, 0.2, 0.3}, radius, 5));
}

void expect_solid(const Mesh& mesh) {
  const Health h = health(mesh);
  EXPECT_TRUE(h.solid()) << h.findings.front();
}

/// Box of sides 6, 8, 10, turned so that nothing lies along the lattice.
Solid turned_box() {
  return moved(solid_of(shapes::box({-3, -4, -5}, {3, 4, 5})),
               glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))));
}

/// Steiner's formula for a convex box and its ball sums.
double box_grown_mm3(double d) {
  return 480 + 376 * d + pi * (6 + 8 + 10) * d * d + 4.0 / 3.0 * pi * d * d * d;
}

TEST(Offset, WallsThinnerThanACellAreFoundMissing) {
  const Solid crate =
      solid_of(shapes::together(shapes::box({0, 0, 0}, {30, 30, 30}),
                                shapes::inside_out(shapes::box({0.4, 0.4, 0.4}, {29.6, 29.6, 29.6}))));
  const auto missed = [&](const Solid& solid, double by_mm, double cell_mm) {
    const OffsetOptions options{.by_mm = by_mm, .cell_mm = cell_mm};
    return missed_walls(solid, offset(solid, options), options);
  };
  EXPECT_EQ(missed(crate, 0.1, 0.4).area_share, 0.0);
  EXPECT_GT(missed(crate, 0.02, 6.0).area_share, 0.1);
  EXPECT_EQ(missed(turned_box(), 0.1, 0.5).area_share, 0.0);
  EXPECT_EQ(missed(turned_box(), -0.5, 0.25).area_share, 0.0);
  // A cleft of 0.3 mm within a box is a wall of what is not in it.
  const Solid cleft = solid_of(shapes::together(
      shapes::box({0, 0, 0}, {30, 30, 30}), shapes::inside_out(shapes::box({5, 5, 14.85}, {25, 25, 15.15}))));
  EXPECT_EQ(missed(cleft, -0.1, 0.4).area_share, 0.0);
  const MissedWalls closed = missed(cleft, -0.02, 4.0);
  EXPECT_GT(closed.area_share, 0.05);
  EXPECT_NEAR(closed.at_mm.z, 15.0, 0.2);
  EXPECT_EQ(missed_walls(cleft, Solid(), {.by_mm = -20.0}).area_share, 0.0);
  EXPECT_EQ(missed_walls(cleft, Solid(), {.by_mm = 1.0}).area_share, 1.0);
}

TEST(Offset, ABallGrowsAndShrinksToBallsWithinTheTolerance) {
  for (const double by : {3.0, -3.0}) {
    double last = 0.0;
    for (const double cell : {2.0, 1.0, 0.5}) {
      const Solid grown = offset(solid_ball(10), {.by_mm = by, .cell_mm = cell});
      expect_solid(grown);
      // The given ball has facets: its own closed form is within 2e-3 of a ball's.
      const double truth = 4.0 / 3.0 * pi * std::pow(10 + by, 3);
      const double error = (truth - volume_mm3(grown)) / truth;
      EXPECT_GT(error, 0.0) << "chords lie within";
      EXPECT_LT(error, 3 * offset_tolerance_mm({.by_mm = by, .cell_mm = cell}) / (10 + by) + 2e-3) << cell;
      if (last > 0.0) {
        EXPECT_LT(error, 0.7 * last) << cell;
      }
      last = error;
    }
  }
}

TEST(Offset, ABoxGrowsBySteinersFormulaAndShrinksToABox) {
  const Solid box = turned_box();
  for (const double d : {0.5, 2.0, 5.0}) {
    const Solid grown = offset(box, {.by_mm = d, .cell_mm = 0.5});
    expect_solid(grown);
    EXPECT_NEAR(volume_mm3(grown), box_grown_mm3(d), 0.006 * box_grown_mm3(d)) << d;
  }
  const Solid shrunk = offset(box, {.by_mm = -2, .cell_mm = 0.25});
  expect_solid(shrunk);
  EXPECT_NEAR(volume_mm3(shrunk), 2 * 4 * 6, 0.02 * 48);
}

TEST(Offset, EveryPointIsAsFarFromTheSolidAsAsked) {
  const Solid box = turned_box();
  const SurfaceTree tree(box);
  for (const double by : {1.5, -1.5}) {
    const Solid grown = offset(box, {.by_mm = by, .cell_mm = 0.4});
    const Triangles points = triangles_of(grown);
    const auto distances = tree.distances_mm(points.points_mm);
    const auto inside = tree.inside(points.points_mm);
    ASSERT_GT(distances.size(), 1000u);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      ASSERT_NEAR(distances[i], 1.5, 0.4e-3 * 2) << "point " << i;
      ASSERT_EQ(inside[i] != 0, by < 0.0) << "point " << i;
    }
  }
}

TEST(Offset, ANeckThinnerThanTwiceTheOffsetFallsApartAndACleftFills) {
  // A dumb-bell of two cubes with a neck 2 mm thick.
  Triangles t = shapes::box({0, 0, 0}, {10, 10, 10});
  const Solid cubes = solid_of(shapes::together(t, shapes::box({12, 0, 0}, {22, 10, 10})));
  EXPECT_EQ(components(offset(cubes, {.by_mm = 0.5, .cell_mm = 0.5})).size(), 2u);
  EXPECT_EQ(components(offset(cubes, {.by_mm = 1.5, .cell_mm = 0.5})).size(), 1u);
  EXPECT_EQ(components(offset(cubes, {.by_mm = -2, .cell_mm = 0.5})).size(), 2u);
  EXPECT_EQ(offset(cubes, {.by_mm = -5.5, .cell_mm = 0.5}).mesh().n_faces(), 0u);
}

TEST(Offset, ByNothingIsTheSurfaceItself) {
  const Solid same = offset(solid_ball(8), {.by_mm = 0.0, .cell_mm = 0.5});
  expect_solid(same);
  EXPECT_NEAR(volume_mm3(same), volume_mm3(solid_ball(8)), 3e-3 * volume_mm3(solid_ball(8)));
}

TEST(Offset, ShellsThatFaceInwardAreCavitiesThatShrinkAsTheSolidGrows) {
  const Triangles hollow =
      shapes::together(shapes::sphere({0, 0, 0}, 9, 4), shapes::inside_out(shapes::sphere({0, 0, 0}, 5, 4)));
  const Solid grown = offset(solid_of(hollow), {.by_mm = 1, .cell_mm = 0.5});
  ASSERT_EQ(components(grown).size(), 1u);
  EXPECT_EQ(components(grown).front().cavities, 1u);
  const double truth = 4.0 / 3.0 * pi * (1000 - 64);
  EXPECT_NEAR(volume_mm3(grown), truth, 0.01 * truth);
}

TEST(Offset, TheSameBitsComeOnAnyNumberOfThreads) {
  const auto points = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return triangles_of(offset(turned_box(), {.by_mm = 1, .cell_mm = 0.7}));
  };
  const Triangles one = points(1), two = points(2);
  EXPECT_EQ(one.points_mm, two.points_mm);
  EXPECT_EQ(one.faces, two.faces);
}

TEST(Offset, RefusesWhatItCannotDoAndStops) {
  const Solid box = turned_box();
  EXPECT_THROW(offset(Solid(), {}), std::invalid_argument);
  EXPECT_THROW(offset(box, {.cell_mm = 0.0}), std::invalid_argument);
  EXPECT_THROW(offset(box, {.by_mm = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(offset(box, {.cell_mm = 1e-6}), std::length_error);
  EXPECT_THROW(offset(box, {.cell_mm = 0.005}), std::length_error);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(offset(box, {.progress = {.stop = stop.get_token()}}), Stopped);
}

}  // namespace
}  // namespace octotomy::brep
