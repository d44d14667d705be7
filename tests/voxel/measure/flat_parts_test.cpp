// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/flat_parts.h"

#include <gtest/gtest.h>

#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

Universe universe_of(const glm::dvec3& spacing_mm) {
  Universe universe;
  universe.depth = 6;
  for (int axis = 0; axis < 3; ++axis) universe.lps_from_voxel[axis][axis] = spacing_mm[axis];
  return universe;
}

TEST(FlatParts, OfABoxAreItsSides) {
  const Octree box = combine(universe_of({1, 1, 2}), Box{{9.6, 9.6, 19.2}, {29.6, 39.6, 59.2}});
  EXPECT_EQ(flat_parts_mm2(box), 2.0 * glm::dvec3(30 * 40, 20 * 40, 20 * 30));
}

TEST(FlatParts, OfBallsAreNoneWhereverTheyLie) {
  for (int i = 1; i <= 40; ++i) {
    const glm::dvec3 off = glm::fract(glm::dvec3(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
    EXPECT_EQ(
        flat_parts_mm2(combine(universe_of(glm::dvec3(1.0)), Sphere{glm::dvec3(31) + off, 6.0 + 0.5 * i})),
        glm::dvec3(0.0))
        << i;
  }
}

TEST(FlatParts, OfAnObliqueCutAreNoneAndOfACutAlongTheLatticeAreTheCut) {
  const Expression ball = Sphere{glm::dvec3(31.3, 30.8, 31.9), 24.0};
  const Universe universe = universe_of(glm::dvec3(1.0));
  const glm::dvec3 oblique = glm::normalize(glm::dvec3(1, 2, 3));
  EXPECT_EQ(flat_parts_mm2(combine(universe, ball & HalfSpace{oblique, glm::dot(oblique, glm::dvec3(31))})),
            glm::dvec3(0.0));
  const glm::dvec3 flat_mm2 = flat_parts_mm2(combine(universe, ball & HalfSpace{{0, 0, 1}, 30.4}));
  EXPECT_EQ(flat_mm2.x, 0.0);
  EXPECT_NEAR(flat_mm2.z, 3.14159 * 24.0 * 24.0, 0.02 * flat_mm2.z);
}

TEST(FlatParts, OfNothingAreNone) {
  EXPECT_EQ(flat_parts_mm2(Octree::empty(universe_of(glm::dvec3(1.0)))), glm::dvec3(0.0));
}

}  // namespace
}  // namespace octotomy::voxel
