// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/line_agreement.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using shapes::box;
using shapes::inside_out;
using shapes::together;

std::optional<LineDisagreement> disagreement(const Triangles& a, const Triangles& b, ResultPlace place,
                                             const Triangles& result) {
  Results results;
  Wanted wanted{};
  results[place] = result;
  wanted[place] = true;
  return disagreement_along_lines(trusted_solid(a, Proof::Connection), trusted_solid(b, Proof::Connection),
                                  results, wanted);
}

Triangles whole_cube() {
  return box({0, 0, 0}, {10, 10, 10});
}
Triangles middle() {
  return box({2, 2, 2}, {8, 8, 8});
}
Triangles hollow_cube() {
  return together(whole_cube(), inside_out(middle()));
}

TEST(LineAgreement, RightResultsAgree) {
  EXPECT_FALSE(disagreement(hollow_cube(), middle(), of_union, whole_cube()));
  EXPECT_FALSE(disagreement(hollow_cube(), middle(), of_intersection, {}));
  EXPECT_FALSE(disagreement(hollow_cube(), middle(), of_a_minus_b, hollow_cube()));
  EXPECT_FALSE(disagreement(hollow_cube(), middle(), of_b_minus_a, middle()));
  EXPECT_FALSE(disagreement(whole_cube(), middle(), of_a_minus_b, hollow_cube()));
  EXPECT_FALSE(disagreement({}, middle(), of_union, middle()));
  EXPECT_FALSE(disagreement({}, {}, of_union, {}));
}

TEST(LineAgreement, AShellTooManyTooFewOrTurnedShows) {
  const auto expect = [](ResultPlace place, const Triangles& wrong, double length_mm) {
    const std::optional<LineDisagreement> found = disagreement(hollow_cube(), middle(), place, wrong);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->result, place);
    EXPECT_NEAR(found->length_mm, length_mm, 1e-12);
    EXPECT_NE(text_of(*found).find("line"), std::string::npos);
  };
  expect(of_intersection, middle(), 6);           // too many
  expect(of_union, hollow_cube(), 6);             // cavity left
  expect(of_a_minus_b, whole_cube(), 6);          // cavity missing
  expect(of_b_minus_a, {}, 6);                    // all missing
  expect(of_b_minus_a, inside_out(middle()), 6);  // turned
  expect(of_a_minus_b, inside_out(hollow_cube()), 10);
}

TEST(LineAgreement, EverySmallShellIsAsked) {
  Triangles many, less;
  for (int i = 0; i < 200; ++i) {
    const Triangles ball = shapes::sphere({1.7 * (i % 20), 2.3 * (i / 20), 0.01 * i}, 0.5, 1);
    many = together(many, ball);
    if (i != 137) less = together(less, ball);
  }
  EXPECT_FALSE(disagreement(many, whole_cube(), of_a_minus_b, {}) == std::nullopt);
  const Triangles far = box({100, 100, 100}, {101, 101, 101});
  EXPECT_FALSE(disagreement(many, far, of_a_minus_b, many));
  EXPECT_TRUE(disagreement(many, far, of_a_minus_b, less));
  EXPECT_TRUE(disagreement(less, far, of_a_minus_b, many));
}

TEST(LineAgreement, HoldsInAnyPoseFarFromTheOriginAndForFilms) {
  for (int pose = 0; pose < 60; ++pose) {
    glm::dmat4 motion = glm::translate(glm::dmat4(1.0), glm::dvec3(500.0 * pose, -30.0, 7.0));
    motion = glm::rotate(motion, 0.1 * pose, glm::normalize(glm::dvec3(pose % 7, 1, pose % 3)));
    const auto placed = [&](Triangles t) {
      for (glm::dvec3& p : t.points_mm) p = glm::dvec3(motion * glm::dvec4(p, 1.0));
      return t;
    };
    const Triangles a = placed(hollow_cube()), b = placed(middle());
    EXPECT_FALSE(disagreement(a, b, of_union, placed(whole_cube()))) << pose;
    const std::optional<LineDisagreement> found = disagreement(a, b, of_intersection, b);
    EXPECT_TRUE(found && found->length_mm > 5.99) << pose;
    // The inner cube's points are off by the last digit, so the wrong region is thinner than rounding.
    Triangles off_by_rounding = b;
    for (glm::dvec3& p : off_by_rounding.points_mm)
      p = glm::dvec3(std::nextafter(p.x, 0.0), std::nextafter(p.y, 1e9), p.z);
    EXPECT_FALSE(disagreement(a, b, of_b_minus_a, off_by_rounding)) << pose;
    EXPECT_FALSE(disagreement(b, off_by_rounding, of_a_minus_b, {})) << pose;
  }
}

}  // namespace
}  // namespace octotomy::brep
