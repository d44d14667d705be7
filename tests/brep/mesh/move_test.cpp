// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/move.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(Move, AQuarterTurnAboutZTakesXToYAndThenTranslates) {
  const Mesh box = mesh_of(shapes::box({0, 0, 0}, {3, 1, 1}));
  glm::dmat4 motion = glm::translate(glm::dmat4(1.0), glm::dvec3(10, 0, 0));
  motion = glm::rotate(motion, std::numbers::pi / 2, glm::dvec3(0, 0, 1));
  const Measures m = measure(moved(box, motion));
  EXPECT_LT(glm::distance(m.low_mm, glm::dvec3(9, 0, 0)), 1e-14);
  EXPECT_LT(glm::distance(m.high_mm, glm::dvec3(10, 3, 1)), 1e-14);
  EXPECT_GT(m.volume_mm3, 0.0);
}

TEST(Move, RefusesWhatIsNotRigid) {
  const Mesh box = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(moved(box, glm::scale(glm::dmat4(1.0), glm::dvec3(1.0, 1.0, 1.0001))), std::invalid_argument);
  EXPECT_THROW(moved(box, glm::scale(glm::dmat4(1.0), glm::dvec3(-1.0, 1.0, 1.0))), std::invalid_argument);
  glm::dmat4 sheared(1.0);
  sheared[1][0] = 1e-3;
  EXPECT_THROW(moved(box, sheared), std::invalid_argument);
  glm::dmat4 projective(1.0);
  projective[0][3] = 1e-3;
  EXPECT_THROW(moved(box, projective), std::invalid_argument);
  glm::dmat4 undefined(1.0);
  undefined[3][0] = NAN;
  EXPECT_THROW(moved(box, undefined), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
