// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/move.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <limits>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/solid.h"
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

TEST(Deform, AScaledAndShearedBoxIsTheParallelepipedOfItsColumns) {
  const Solid box = solid_of(shapes::box({-1, -2, -3}, {1, 2, 3}));
  glm::dmat4 map(1.0);
  map[0] = {2, 0, 0, 0};
  map[1] = {0.5, 1, 0, 0};
  map[2] = {0, 0.25, 3, 0};
  map[3] = {7, 8, 9, 1};
  const Solid made = deformed(box, map);
  EXPECT_NEAR(made.size().volume_mm3, 2.0 * 4.0 * 6.0 * 6.0, 1e-10);
  // Each face is the cross product of two columns.
  const glm::dvec3 a(4, 0, 0), b(2, 4, 0), c(0, 1.5, 18);
  EXPECT_NEAR(
      made.size().area_mm2,
      2.0 * (glm::length(glm::cross(a, b)) + glm::length(glm::cross(b, c)) + glm::length(glm::cross(a, c))),
      1e-10);
  EXPECT_LT(glm::distance(*made.measures().centroid_mm, glm::dvec3(7, 8, 9)), 1e-12);
  EXPECT_EQ(made.proof(), Proof::Rounded);
  EXPECT_TRUE(health(made.triangles()).solid());
}

TEST(Deform, TheInverseMapBringsEveryPointBack) {
  const Solid ball = solid_of(shapes::sphere({0, 0, 0}, 10.0, 3));
  glm::dmat4 map = glm::rotate(glm::dmat4(1.0), 0.7, glm::dvec3(1, 2, 3));
  map = glm::scale(map, glm::dvec3(0.5, 1.25, 2.0));
  map[3] = {3, -4, 5, 1};
  const Triangles before = ball.triangles(),
                  after = deformed(deformed(ball, map), glm::inverse(map)).triangles();
  ASSERT_EQ(before.faces, after.faces);
  for (std::size_t i = 0; i < before.points_mm.size(); ++i)
    EXPECT_LT(glm::distance(before.points_mm[i], after.points_mm[i]), 1e-13);
}

TEST(Deform, RefusesMapsThatMirrorFlattenOrAreNoNumbers) {
  const Solid box = solid_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  const auto refusal = [&](const glm::dmat4& map) -> std::string {
    try {
      deformed(box, map);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1))).find("mirrors"), std::string::npos);
  EXPECT_NE(refusal(glm::scale(glm::dmat4(1.0), glm::dvec3(1, 0, 1))).find("singular"), std::string::npos);
  glm::dmat4 projective(1.0);
  projective[1][3] = 0.5;
  EXPECT_NE(refusal(projective).find("last row"), std::string::npos);
  glm::dmat4 undefined(1.0);
  undefined[3][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(undefined).find("not finite"), std::string::npos);
  EXPECT_NE(refusal(glm::scale(glm::dmat4(1.0), glm::dvec3(1, 1, 1e308)) *
                    glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 9)))
                .find("finite"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::brep
