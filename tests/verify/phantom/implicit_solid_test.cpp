// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/implicit_solid.h"

#include <gtest/gtest.h>
#include <random>

#include "verify/phantom/head_phantom.h"
#include "verify/phantom/head_solids.h"

namespace octotomy::verify {
namespace {

glm::dvec3 random_point(std::mt19937_64& random, double low, double high) {
  std::uniform_real_distribution<double> along(low, high);
  const double x = along(random), y = along(random), z = along(random);
  return {x, y, z};
}

// Values of a form at pairs of near points; the largest change by distance.
double steepest(const ImplicitSolid& form, std::uint64_t seed, int pairs) {
  std::mt19937_64 random(seed);
  double found = 0.0;
  for (int i = 0; i < pairs; ++i) {
    const glm::dvec3 a = random_point(random, -110.0, 110.0);
    const glm::dvec3 b = a + random_point(random, -0.5, 0.5);
    found = std::max(found, std::abs(form(a) - form(b)) / glm::length(a - b));
  }
  return found;
}

TEST(ImplicitSolid, ValuesNeverChangeFasterThanPositionAsScanningReliesOn) {
  const HeadSolids& head = head_solids();
  EXPECT_LE(steepest(head.bone, 1, 20000), 1.0 + 1e-9);
  EXPECT_LE(steepest(head.skin, 2, 20000), 1.0 + 1e-9);
  EXPECT_LE(steepest(head.air, 3, 20000), 1.0 + 1e-9);
  // Not vacuous: boxes and round capsules are exact, so the bound is met somewhere.
  EXPECT_GE(steepest(head.bone, 1, 20000), 0.99);
}

TEST(ImplicitSolid, EllipsoidAndStretchedCapsuleHaveTheirClosedFormSurface) {
  const glm::dmat3 turn = turned({20, -35, 70});
  const ImplicitSolid form = ellipsoid({3, -2, 5}, {10, 20, 5}, turn);
  for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}, {0.6, 0.0, 0.8}}) {
    const glm::dvec3 on_surface = glm::dvec3(3, -2, 5) + turn * (direction * glm::dvec3(10, 20, 5));
    EXPECT_NEAR(form(on_surface), 0.0, 1e-12);
  }
  EXPECT_DOUBLE_EQ(form({3, -2, 5}), -5.0);
  const ImplicitSolid capsule = tapered_capsule({{0, 0, 0}, 4.0}, {{10, 0, 0}, 2.0}, {1, 1, 2});
  EXPECT_NEAR(capsule({0, 4, 0}), 0.0, 1e-12);
  EXPECT_NEAR(capsule({0, 0, 8}), 0.0, 1e-12);
  EXPECT_NEAR(capsule({12, 0, 0}), 0.0, 1e-12);
  EXPECT_GT(capsule({12.1, 0, 0}), 0.0);
}

TEST(ImplicitSolid, MirroringMovesTheSolidToTheOtherSideAndTurnsItsFrameToo) {
  const ImplicitSolid form = ellipsoid({30, 4, 2}, {3, 9, 5}, turned({0, 0, 30}));
  const ImplicitSolid mirror = mirrored(form);
  std::mt19937_64 random(7);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 p = random_point(random, -40.0, 40.0);
    EXPECT_NEAR(form(p), mirror({-p.x, p.y, p.z}), 1e-12);
  }
  EXPECT_LT(mirror({-30, 4, 2}), 0.0);
  EXPECT_GT(mirror({30, 4, 2}), 0.0);
}

TEST(ImplicitSolid, BlendedUnionsAreTheUnionWhereTheirPartsAreApartAndMoreBetween) {
  const ImplicitSolid a = ellipsoid({-6, 0, 0}, glm::dvec3(5)), b = ellipsoid({6, 0, 0}, glm::dvec3(5));
  const ImplicitSolid both = blended(a, b, 4.0);
  EXPECT_DOUBLE_EQ(both({-11, 0, 0}), a({-11, 0, 0}));
  EXPECT_NEAR(both({0, 0, 0}), 1.0 - 1.0, 1e-12);  // a quarter of the width below the minimum
}

TEST(ImplicitSolid, PrunedStepsGiveTheSameValueThroughoutTheirBall) {
  const ImplicitSolid::Steps& whole = head_solids().bone.steps();
  std::mt19937_64 random(11);
  std::size_t kept = 0;
  for (int ball = 0; ball < 300; ++ball) {
    const glm::dvec3 centre = random_point(random, -90.0, 90.0);
    const double radius = 4.0;
    ImplicitSolid::Steps pruned;
    prune(whole, centre, radius, pruned);
    kept += pruned.size();
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 offset = random_point(random, -1.0, 1.0);
      const glm::dvec3 p = centre + offset * (radius / std::max(1.0, glm::length(offset)));
      ASSERT_EQ(value(whole, p), value(pruned, p)) << "ball " << ball << " of seed 11, radius " << radius;
    }
  }
  EXPECT_LT(kept, 300 * whole.size() / 10);
}

// The twin that must fail: steps used beyond their ball.
TEST(ImplicitSolid, PrunedStepsAreWrongFarFromTheirBall) {
  const ImplicitSolid::Steps& whole = head_solids().bone.steps();
  ImplicitSolid::Steps pruned;
  prune(whole, {0, -80, -50}, 2.0, pruned);
  EXPECT_NE(value(whole, {0, 20, 100}), value(pruned, {0, 20, 100}));
}

TEST(HeadBricks, AnswerAsTheWholeFormsDoInsideAndOutsideTheBounds) {
  int decided = 0;
  std::mt19937_64 random(13);
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 p = random_point(random, -140.0, 140.0);
    const HeadBricks::Fields& fields = HeadBricks::instance().at(p).steps;
    EXPECT_EQ(value(fields[HeadBricks::Bone], p), head_solids().bone(p));
    EXPECT_EQ(value(fields[HeadBricks::Skin], p), head_solids().skin(p));
    EXPECT_EQ(value(fields[HeadBricks::Air], p), head_solids().air(p));
    const signed char place = HeadBricks::instance().at(p).places[HeadBricks::Bone];
    if (place >= 0) {
      EXPECT_EQ(place == 1, head_solids().bone(p) < 0.0);
    }
    decided += place >= 0;
  }
  EXPECT_GT(decided, 300);
}

}  // namespace
}  // namespace octotomy::verify
