// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/anatomy/head_directions.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

constexpr glm::dmat3 level_axes(1.0);

double apart(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::distance(a, b);
}

TEST(HeadDirections, ForwardIsMinusYLeftIsXAndUpIsZInTheScansFrame) {
  EXPECT_LT(apart(lps_mm({6, 0, 0}, level_axes), {0, -6, 0}), 1e-12);
  EXPECT_LT(apart(lps_mm({0, 2, 0}, level_axes), {2, 0, 0}), 1e-12);
  EXPECT_LT(apart(lps_mm({0, 0, 3}, level_axes), {0, 0, 3}), 1e-12);
  EXPECT_EQ(in_words(displacement_of({0.3, -6.0, -1.9}, level_axes)),
            "forward 6.0 mm, down 1.9 mm, left 0.3 mm");
  EXPECT_EQ(in_words(displacement_of({-2.0, 1.0, 0.0}, level_axes)), "back 1.0 mm, right 2.0 mm");
  EXPECT_EQ(in_words(Displacement{}), "no movement");
  EXPECT_FALSE(std::signbit(displacement_of({0, 0, 3}, level_axes).forward_mm)) << "a negative zero";
}

TEST(HeadDirections, EachTurnTakesWhatItsSignSays) {
  const glm::dvec3 front(0, -1, 0), left(1, 0, 0);
  EXPECT_GT((rotation_of({10, 0, 0}, level_axes) * front).z, 0.1) << "pitch: the front goes up";
  EXPECT_GT((rotation_of({0, 10, 0}, level_axes) * front).x, 0.1) << "yaw: the front goes to the left";
  EXPECT_GT((rotation_of({0, 0, 10}, level_axes) * left).z, 0.1) << "roll: the left side goes up";
  // A rotation about the patient's left, right-handed, lowers the front.
  const auto turned = turns_of(glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(5.0), left)), level_axes);
  EXPECT_NEAR(turned.pitch_deg, -5.0, 1e-9);
  EXPECT_EQ(in_words(turned), "pitch \u22125.0\u00b0 (front down), yaw 0.0\u00b0, roll 0.0\u00b0");
}

TEST(HeadDirections, TurnsAreFoundBackInAnyHeadAlsoAtAPitchOfNinety) {
  const glm::dmat3 held(glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))));
  for (const Turns& turns : {Turns{12, -34, 56}, Turns{-80, 170, -20}, Turns{0, 0, 179}, Turns{3, 2, 1}}) {
    const Turns back = turns_of(rotation_of(turns, held), held);
    EXPECT_NEAR(back.pitch_deg, turns.pitch_deg, 1e-9);
    EXPECT_NEAR(back.yaw_deg, turns.yaw_deg, 1e-9);
    EXPECT_NEAR(back.roll_deg, turns.roll_deg, 1e-9);
  }
  const glm::dmat3 upright = rotation_of({90, 25, 0}, level_axes);
  const Turns back = turns_of(upright, level_axes);
  EXPECT_NEAR(back.pitch_deg, 90.0, 1e-5);
  const glm::dmat3 again = rotation_of(back, level_axes);
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(apart(again[axis], upright[axis]), 1e-6);
}

TEST(HeadDirections, WordsFollowTheHeadAndNotTheScan) {
  // A head that lies on its left side: its up is the scan's right.
  const glm::dmat3 lying{glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0)};
  EXPECT_EQ(in_words(displacement_of({4, 0, 0}, lying)), "up 4.0 mm");
  EXPECT_EQ(in_words(displacement_of({0, 0, 4}, lying)), "right 4.0 mm");
}

}  // namespace
}  // namespace octotomy::planner
