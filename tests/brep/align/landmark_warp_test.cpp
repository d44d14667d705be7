// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/landmark_warp.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

const std::vector<glm::dvec3> places_mm{{0, -100, 0}, {0, -95, -20}, {12, -90, -30}, {-3, -99, 14}};
const std::vector<glm::dvec3> shifts_mm{{0, -2, 1}, {0.5, -3, 0}, {0, 0, 0}, {0, -1, 0.3}};

TEST(LandmarkWarp, EachLandmarkMovesAsStatedAndNothingMovesOutOfReach) {
  const LandmarkWarp warp(places_mm, shifts_mm, 40.0);
  for (std::size_t i = 0; i < places_mm.size(); ++i)
    EXPECT_LT(glm::distance(warp.at(places_mm[i]), shifts_mm[i]), 1e-12) << i;
  EXPECT_EQ(warp.at({0, -100, 55}), glm::dvec3(0.0));
  EXPECT_EQ(warp.at({0, 100, 0}), glm::dvec3(0.0));
}

TEST(LandmarkWarp, OneLandmarkHasWendlandsFunctionAboutIt) {
  const LandmarkWarp warp({{1, 2, 3}}, {{0, -4, 0}}, 50.0);
  for (const double r : {0.0, 0.1, 0.25, 0.5, 0.9, 1.0}) {
    const double expected = -4.0 * std::pow(1.0 - r, 4) * (4.0 * r + 1.0);
    EXPECT_NEAR(warp.at({1, 2 + 50.0 * r, 3}).y, expected, 1e-12) << r;
  }
  // The steepest slope is 135/64 of the displacement over the reach, at a quarter of it.
  EXPECT_GE(warp.steepest(), 135.0 / 64.0 * 4.0 / 50.0);
  EXPECT_LT(warp.steepest(), 1.3 * 135.0 / 64.0 * 4.0 / 50.0);
}

TEST(LandmarkWarp, NoTwoPointsChangeFasterThanTheSteepest) {
  const LandmarkWarp warp(places_mm, shifts_mm, 40.0);
  const double steepest = warp.steepest();
  double found = 0.0;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 50000; ++i) {
    const glm::dvec3 p = glm::dvec3(0, -95, -5) + 40.0 * glm::dvec3(any(random), any(random), any(random));
    const glm::dvec3 q = p + 0.2 * glm::dvec3(any(random), any(random), any(random));
    found = std::max(found, glm::distance(warp.at(p), warp.at(q)) / glm::distance(p, q));
  }
  EXPECT_LE(found, steepest);
  EXPECT_GT(found, 0.4 * steepest);
}

TEST(LandmarkWarp, ASolidMovesByItsPointsAndKeepsItsTriangles) {
  Triangles tetrahedron{{{0, -100, 0}, {9, -100, 0}, {0, -91, 0}, {0, -100, 9}},
                        {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const Solid solid = solid_of(tetrahedron);
  const LandmarkWarp warp(places_mm, shifts_mm, 40.0);
  const Solid made = warped(solid, warp);
  EXPECT_EQ(made.triangles().faces, solid.triangles().faces);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(made.triangles().points_mm[i],
              solid.triangles().points_mm[i] + warp.at(solid.triangles().points_mm[i]));
  EXPECT_TRUE(warped(Solid(), warp).empty());
}

TEST(LandmarkWarp, WrongInputIsRefused) {
  EXPECT_THROW(LandmarkWarp({}, {}, 40.0), InvalidInput);
  EXPECT_THROW(LandmarkWarp(places_mm, {{0, 0, 0}}, 40.0), InvalidInput);
  EXPECT_THROW(LandmarkWarp(places_mm, shifts_mm, 0.0), InvalidInput);
  EXPECT_THROW(LandmarkWarp({{1, 2, 3}, {1, 2, 3}}, {{0, 0, 0}, {0, 0, 1}}, 40.0), InvalidInput);
  EXPECT_THROW(LandmarkWarp({{1, 2, NAN}}, {{0, 0, 0}}, 40.0), InvalidInput);
}

}  // namespace
}  // namespace octotomy::brep
