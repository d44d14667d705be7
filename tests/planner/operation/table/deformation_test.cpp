// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/deformation.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "verify/phantom/chance.h"

namespace octotomy::planner {
namespace {

TEST(Deformation, FactorsOfAScaleBetweenTwoRotationsAreItsOwn) {
  verify::Chance chance(3);
  for (int i = 0; i < 200; ++i) {
    const auto turn = [&] {
      return glm::dmat3(glm::rotate(glm::dmat4(1.0), 3.0 * chance.normal(),
                                    glm::dvec3(chance.normal(), chance.normal(), chance.normal() + 0.01)));
    };
    const glm::dvec3 factors(0.4, 0.4 + 0.01 * i, 3.0);
    glm::dmat3 scale(1.0);
    for (int axis = 0; axis < 3; ++axis) scale[axis][axis] = factors[axis];
    const Deformation found = deformation_of(turn() * scale * turn());
    EXPECT_NEAR(found.volume_factor, factors.x * factors.y * factors.z, 1e-13);
    EXPECT_NEAR(found.least_length, 0.4, 1e-14);
    EXPECT_NEAR(found.greatest_length, 3.0, 1e-14);
    EXPECT_NEAR(found.least_area, 0.4 * factors.y, 1e-13);
    EXPECT_NEAR(found.greatest_area, 3.0 * factors.y, 1e-13);
  }
}

TEST(Deformation, TheGreatestChangeOfAnAngleIsThatOfManyPairsOfDirections) {
  glm::dmat3 map(1.0);
  map[2][0] = 0.6;  // a shear
  double most_deg = 0.0;
  const auto angle = [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::degrees(std::acos(std::clamp(glm::dot(a, b) / glm::length(a) / glm::length(b), -1.0, 1.0)));
  };
  for (int i = 0; i < 720; ++i)
    for (int j = 0; j < i; ++j) {
      const glm::dvec3 a(std::sin(M_PI * i / 360), 0, std::cos(M_PI * i / 360));
      const glm::dvec3 b(std::sin(M_PI * j / 360), 0, std::cos(M_PI * j / 360));
      most_deg = std::max(most_deg, std::abs(angle(map * a, map * b) - angle(a, b)));
    }
  const double found_deg = deformation_of(map).most_angle_deg;
  EXPECT_LE(most_deg, found_deg + 1e-9);
  EXPECT_GT(most_deg, found_deg - 0.02);
}

TEST(Deformation, TheNearestRotationLosesTheScaleAndKeepsARigidMapToTheBit) {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), 0.5, glm::dvec3(1, 2, -1));
  EXPECT_EQ(nearest_rotation(turn), glm::dmat3(turn));
  // A symmetric positive stretch does not rotate.
  glm::dmat3 stretch(1.2, 0.1, 0.0, 0.1, 0.8, 0.05, 0.0, 0.05, 1.5);
  const glm::dmat3 found = nearest_rotation(turn * glm::dmat4(stretch));
  for (int column = 0; column < 3; ++column)
    EXPECT_LT(glm::distance(found[column], glm::dvec3(turn[column])), 1e-14);
}

TEST(Deformation, OnlyMapsThatKeepLengthsAndSidesAreRigid) {
  EXPECT_TRUE(is_rigid(glm::dmat4(1.0)));
  EXPECT_FALSE(is_rigid(glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, 1.0, 1.001))));
  const glm::dmat4 mirror = glm::scale(glm::dmat4(1.0), glm::dvec3(1, -1, 1));
  EXPECT_FALSE(is_rigid(mirror));
  EXPECT_TRUE(keeps_lengths(mirror));
  EXPECT_EQ(stretch_of(mirror), 1.0);
  EXPECT_NEAR(stretch_of(glm::scale(glm::dmat4(1.0), glm::dvec3(0.5, 2.5, 1.0))), 2.5, 1e-14);
}

TEST(Deformation, WordsStateThatItIsNoRigidMotion) {
  EXPECT_EQ(
      in_words(deformation_of(glm::dmat3(glm::scale(glm::dmat4(1.0), glm::dvec3(1.5, 1.0, 1.0))))),
      "no rigid motion: volumes change by the factor 1.50, lengths by 1.00 to 1.50, angles by up to 23.1°");
}

}  // namespace
}  // namespace octotomy::planner
