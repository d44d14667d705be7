// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/settle.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"

namespace octotomy::brep {
namespace {

using tests::told;

/// A box with two triangles of its top divided at a point that rounding put `below` of a side's end: the small
/// triangle there is turned over.
Triangles folded_box(double along, double below) {
  Triangles t = shapes::box({0, 0, 0}, {1, 1, 1});
  // The top's triangles are (4, 5, 7) and (4, 7, 6). Their diagonal gets two points, in the wrong order.
  t.points_mm.emplace_back(0.5 + along, 0.5 + along, 1.0);
  t.points_mm.emplace_back(0.5, 0.5, 1.0 + below);
  const std::uint32_t one = 8, other = 9;
  std::erase_if(t.faces, [](const auto& f) { return f[0] == 4 && f[1] >= 5 && f[2] >= 6 && f[1] != f[2]; });
  for (const auto& [p, q] : {std::pair{4U, one}, {one, other}, {other, 7U}}) {
    t.faces.push_back({p, 5, q});
    t.faces.push_back({p, q, 6});
  }
  return t;
}

std::array<const Triangles*, 2> operands_of(const Triangles& a, const Triangles& b) {
  return {&a, &b};
}

TEST(Settle, ATriangleThatRoundingTurnedOverIsTakenOut) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 1, 1}), other = shapes::box({0, 0, 0}, {2, 2, 2});
  for (const double along : {1e-15, 1e-12, 1e-9, 1e-7}) {
    const Triangles folded = folded_box(along, 0.0);
    ASSERT_GT(health(folded).self_intersections + health(folded).degenerate_faces, 0U) << along;
    const Settled done = settled(folded, operands_of(box, other));
    EXPECT_EQ(done.crossing, 0U) << along;
    const Health found = health(done.surface);
    EXPECT_TRUE(found.solid()) << along << ": " << told(found);
    EXPECT_NEAR(volume_mm3(trusted_solid(done.surface, Proof::Rounded)), 1.0, 1e-14) << along;
  }
}

TEST(Settle, ASurfaceWithoutFoldsIsReturnedToTheLastBit) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 1, 1}), other = shapes::box({0, 0, 0}, {2, 2, 2});
  const Triangles divided = folded_box(-1e-3, 0.0);
  ASSERT_TRUE(health(divided).solid());
  const Settled done = settled(divided, operands_of(box, other));
  EXPECT_EQ(done.surface.points_mm, divided.points_mm);
  EXPECT_EQ(done.surface.faces, divided.faces);
}

TEST(Settle, AFoldThatNoRoundingExplainsStaysAndIsReported) {
  const Triangles box = shapes::box({0, 0, 0}, {1, 1, 1}), other = shapes::box({0, 0, 0}, {2, 2, 2});
  const Triangles folded = folded_box(0.4, 0.0);
  const Settled done = settled(folded, operands_of(box, other));
  EXPECT_GT(done.crossing, 0U);
  EXPECT_EQ(done.crossing, health(folded).self_intersections);
  EXPECT_EQ(done.surface.points_mm, folded.points_mm);
}

TEST(Settle, BooleansOfBoxesTurnedByVerySmallAnglesAreSolids) {
  int made = 0;
  for (int seed = 0; seed < 60; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> place(-50.0, 50.0), exponent(-13.0, -7.0);
    std::normal_distribution<double> along;
    const auto axis = [&] { return glm::normalize(glm::dvec3(along(random), along(random), along(random))); };
    const glm::dmat4 pose = glm::rotate(
        glm::translate(glm::dmat4(1.0), {place(random), place(random), place(random)}), 1.0, axis());
    const glm::dmat4 turned = pose * glm::rotate(glm::dmat4(1.0), std::pow(10.0, exponent(random)), axis());
    Triangles a = shapes::box({0, 0, 0}, {2, 2, 2}), b = shapes::box({1, 0, 0}, {3, 2, 2});
    for (glm::dvec3& p : a.points_mm) p = glm::dvec3(pose * glm::dvec4(p, 1.0));
    for (glm::dvec3& p : b.points_mm) p = glm::dvec3(turned * glm::dvec4(p, 1.0));
    const BooleanResult result = boolean(solid_of(a), Operation::Union, solid_of(b));
    EXPECT_NEAR(volume_mm3(result.solid), 12.0, 1e-6) << "seed " << seed;
    const Health found = health(result.solid.triangles());
    EXPECT_TRUE(found.solid() || !result.findings.empty()) << "seed " << seed << ": " << told(found);
    made += found.solid();
  }
  EXPECT_GE(made, 55);
}

}  // namespace
}  // namespace octotomy::brep
