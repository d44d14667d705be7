// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/shadow.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <tbb/global_control.h>
#include <tuple>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/shape/prism.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

const glm::dvec3 oblique = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));

Shadow to_far_end(const Solid& solid, const glm::dvec3& direction, double beyond_mm = 0.0) {
  return shadow(solid, {direction, far_end_mm(solid, direction) + beyond_mm});
}

void expect_healthy(const Solid& solid) {
  const Health found = health(solid.mesh());
  EXPECT_TRUE(found.solid()) << found.findings.front();
}

/// The solid turned so that the direction -z becomes `direction`.
Solid aimed(const Solid& solid, const glm::dvec3& direction) {
  const glm::dvec3 down(0.0, 0.0, -1.0), axis = glm::cross(down, direction);
  const double angle = std::atan2(glm::length(axis), glm::dot(down, direction));
  return moved(solid, glm::rotate(glm::dmat4(1.0), angle, glm::normalize(axis)));
}

/// A many-sided prism about z.
Solid post(int sides, double radius, double from_mm, double to_mm) {
  Prism prism;
  prism.look = {0.0, 0.0, 1.0};
  prism.up = {0.0, 1.0, 0.0};
  prism.right = glm::cross(prism.look, prism.up);
  prism.polygons_mm.emplace_back();
  for (int i = 0; i < sides; ++i)
    prism.polygons_mm[0].push_back(
        radius * glm::dvec2(std::cos(2.0 * pi * i / sides), std::sin(2.0 * pi * i / sides)));
  prism.from_mm = from_mm;
  prism.to_mm = to_mm;
  return solid_of(prism);
}
double disc_mm2(int sides, double radius) {
  return 0.5 * sides * radius * radius * std::sin(2.0 * pi / sides);
}

TEST(Shadow, OfABoxAlongItsAxisIsTheBox) {
  const Solid box = solid_of(shapes::box({-3, -4, -5}, {3, 4, 5}));
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 direction(0.0);
      direction[axis] = sign;
      const Shadow made = to_far_end(box, direction);
      expect_healthy(made.solid);
      EXPECT_DOUBLE_EQ(volume_mm3(made.solid), 480.0);
      EXPECT_EQ(made.seen, 2u);
      EXPECT_DOUBLE_EQ(volume_mm3(to_far_end(box, direction, 2.0).solid),
                       480.0 + 2.0 * 480.0 / (2.0 * (3 + axis)));
    }
}

TEST(Shadow, OfABallIsItsHalfAndARoundPost) {
  const Solid ball = solid_of(shapes::sphere({0.1, 0.2, 0.3}, 10.0, 5));
  const double truth = 2.0 / 3.0 * pi * 1000.0 + pi * 1000.0;
  for (const glm::dvec3& direction : {glm::dvec3(0, 1, 0), oblique, -oblique}) {
    const Shadow made = to_far_end(ball, direction);
    expect_healthy(made.solid);
    EXPECT_NEAR(volume_mm3(made.solid) / truth, 1.0, 2e-3);
    EXPECT_LT(volume_mm3(made.solid), truth);
  }
}

TEST(Shadow, KeepsThePointsThatAreSeen) {
  const Solid ball = solid_of(shapes::sphere({0.1, 0.2, 0.3}, 10.0, 4));
  const Shadow made = to_far_end(ball, oblique, 3.0);
  std::set<std::tuple<double, double, double>> points;
  for (const glm::dvec3& p : made.solid.triangles().points_mm) points.emplace(p.x, p.y, p.z);
  std::size_t on_front = 0;
  for (const glm::dvec3& p : ball.triangles().points_mm) {
    if (glm::dot(p - glm::dvec3(0.1, 0.2, 0.3), oblique) > -0.5) continue;
    ++on_front;
    EXPECT_TRUE(points.contains({p.x, p.y, p.z})) << p.x << ' ' << p.y << ' ' << p.z;
  }
  EXPECT_GT(on_front, 400u);
}

TEST(Shadow, OfAMushroomFillsBelowItsCap) {
  // A cap of radius 5 from z = 4 to 6 on a stem of radius 2 from 0 to 4.
  for (const glm::dvec3& direction : {glm::dvec3(0, 0, -1), oblique}) {
    const Solid still = boolean(post(60, 5.0, 4.0, 6.0), Operation::Union, post(40, 2.0, 0.0, 4.5)).solid;
    const Solid mushroom = direction.z == -1.0 ? still : aimed(still, direction);
    const Shadow made = to_far_end(mushroom, direction);
    expect_healthy(made.solid);
    EXPECT_NEAR(volume_mm3(made.solid), 6.0 * disc_mm2(60, 5.0), 1e-6);
    // From below, the stem's end and the ring of the cap are seen; behind both all is filled.
    const Shadow turned = to_far_end(mushroom, -direction);
    expect_healthy(turned.solid);
    EXPECT_NEAR(volume_mm3(turned.solid), volume_mm3(mushroom), 1e-6);
  }
}

TEST(Shadow, OfAWedgeThatLeansIsFilledToItsEnd) {
  // A bar whose side leans out upward: 45 degrees of undercut, 10 long.
  Prism prism;
  prism.look = {1, 0, 0};
  prism.up = {0, 0, 1};
  prism.right = glm::cross(prism.look, prism.up);
  prism.polygons_mm = {{{0, 0}, {4, 0}, {8, 4}, {0, 4}}};
  prism.to_mm = 10.0;
  const Solid bar = solid_of(prism);
  const Shadow made = to_far_end(bar, {0, 0, -1});
  expect_healthy(made.solid);
  EXPECT_NEAR(volume_mm3(made.solid) - volume_mm3(bar), 0.5 * 16.0 * 10.0, 1e-9);
  // Along the leaning side the lines of sight enter through the top, which is 8 wide, and end on the plane
  // through the corner at (0, 0). What they cover is a right triangle with legs of 8.
  const Shadow leaning = to_far_end(bar, glm::normalize(-prism.right - prism.up));
  expect_healthy(leaning.solid);
  EXPECT_NEAR(volume_mm3(leaning.solid), 0.5 * 8.0 * 8.0 * 10.0, 1e-8);
}

TEST(Shadow, WhatLiesBehindIsCoveredWhereItIsHidden) {
  // A small box wholly behind a large one, and one half behind.
  const Solid front = solid_of(shapes::box({0, 0, 8}, {10, 10, 10}));
  const auto with = [&](const glm::dvec3& low, const glm::dvec3& high) {
    return solid_of(shapes::together(front.triangles(), shapes::box(low, high)));
  };
  const Shadow hidden = to_far_end(with({2, 2, 0}, {4, 4, 5}), {0, 0, -1});
  expect_healthy(hidden.solid);
  EXPECT_DOUBLE_EQ(volume_mm3(hidden.solid), 1000.0);
  const Shadow half = to_far_end(with({8, 2, 0}, {12, 4, 5}), {0, 0, -1});
  expect_healthy(half.solid);
  EXPECT_DOUBLE_EQ(volume_mm3(half.solid), 1000.0 + 2 * 2 * 5);
}

TEST(Shadow, CavitiesAndClefsAreFilledAndTheResultIsItsOwnShadow) {
  const Solid crate = solid_of(shapes::together(shapes::box({0, 0, 0}, {9, 9, 9}),
                                                shapes::inside_out(shapes::box({1, 1, 1}, {8, 8, 8}))));
  const Shadow full = to_far_end(crate, oblique);
  expect_healthy(full.solid);
  // The silhouette's area times the way from the middle to the end, and half the box.
  const double sum = std::abs(oblique.x) + std::abs(oblique.y) + std::abs(oblique.z);
  EXPECT_NEAR(volume_mm3(full.solid), 81.0 * sum * 4.5 * sum + 0.5 * 729.0, 1e-8);
  const Solid ring = solid_of(shapes::torus(8.0, 2.5, 60, 30));
  for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), oblique}) {
    const Shadow once = to_far_end(ring, direction);
    expect_healthy(once.solid);
    const Shadow twice = to_far_end(once.solid, direction);
    EXPECT_NEAR(volume_mm3(twice.solid), volume_mm3(once.solid), 1e-6);
  }
}

TEST(Shadow, TheSameBitsOnOneThreadAndMany) {
  const Solid ring = solid_of(shapes::torus(8.0, 2.5, 60, 30));
  const Triangles many = to_far_end(ring, oblique).solid.triangles();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Triangles alone = to_far_end(ring, oblique).solid.triangles();
  EXPECT_EQ(many.faces, alone.faces);
  EXPECT_TRUE(many.points_mm == alone.points_mm);
}

TEST(Shadow, RefusesADirectionWithoutLength) {
  const Solid box = solid_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(shadow(box, {{0, 0, 0}, 1.0}), std::invalid_argument);
  EXPECT_THROW(shadow(box, {{0, 0, 2}, 1.0}), std::invalid_argument);
  EXPECT_THROW(shadow(box, {{0, 0, 1}, std::numeric_limits<double>::infinity()}), std::invalid_argument);
  EXPECT_TRUE(shadow(Solid(), {{0, 0, 1}, 1.0}).solid.empty());
}

}  // namespace
}  // namespace octotomy::brep
