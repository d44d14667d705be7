// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/measure.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/voxel/dense.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

constexpr double pi = std::numbers::pi;

Universe cube_mm(double half_mm, double voxel_mm) {
  return universe_around({glm::dvec3(-half_mm), glm::dvec3(half_mm)}, voxel_mm);
}

TEST(Measure, ABoxOnTheLatticeIsExact) {
  const Universe universe = cube_mm(32, 0.5);
  const Measures m = measure(combine(universe, Box{{-10, -5, 2}, {6, 20, 8.5}}));
  EXPECT_DOUBLE_EQ(m.volume_mm3, 16 * 25 * 6.5);
  EXPECT_DOUBLE_EQ(m.exposed_mm2.x, 2 * 25 * 6.5);
  EXPECT_DOUBLE_EQ(m.exposed_mm2.y, 2 * 16 * 6.5);
  EXPECT_DOUBLE_EQ(m.exposed_mm2.z, 2 * 16 * 25);
  ASSERT_TRUE(m.centroid_mm && m.extents);
  EXPECT_NEAR(glm::distance(*m.centroid_mm, glm::dvec3(-2, 7.5, 5.25)), 0.0, 1e-12);
  EXPECT_EQ(m.extents->low_mm, glm::dvec3(-10, -5, 2));
  EXPECT_EQ(m.extents->high_mm, glm::dvec3(6, 20, 8.5));
  const double mass = 16 * 25 * 6.5 / 12.0;
  ASSERT_TRUE(m.inertia_mm5);
  EXPECT_NEAR((*m.inertia_mm5)[0][0], mass * (25 * 25 + 6.5 * 6.5), 1e-6);
  EXPECT_NEAR((*m.inertia_mm5)[1][1], mass * (16 * 16 + 6.5 * 6.5), 1e-6);
  EXPECT_NEAR((*m.inertia_mm5)[2][2], mass * (16 * 16 + 25 * 25), 1e-6);
  EXPECT_NEAR((*m.inertia_mm5)[0][1], 0.0, 1e-6);
  // Lindblad's known loss on flats that lie along the lattice.
  const double area = 2 * (16 * 25 + 16 * 6.5 + 25 * 6.5);
  EXPECT_NEAR(*m.area_lindblad_mm2 / area, 0.927, 0.03);
}

TEST(Measure, InertiaTurnsWithTheObject) {
  // The same voxels on a lattice that is turned have the turned tensor.
  const tests::Dense dense = tests::random_dense(16, 3);
  const Universe still{4, glm::dmat4(1.0)};
  const glm::dmat4 turn = moved_from_still({.translate_mm = {5, 6, 7}, .degrees = 40, .axis = {1, 2, 3}});
  const glm::dmat3 by(turn);
  const glm::dmat3 expected = by * *measure(tests::octree_of(still, dense)).inertia_mm5 * glm::transpose(by);
  const glm::dmat3 turned = *measure(tests::octree_of({4, turn}, dense)).inertia_mm5;
  EXPECT_GT(std::abs(expected[0][1]), 1.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(turned[i][j], expected[i][j], 1e-9 * expected[0][0]);
}

TEST(Measure, ASpheresVolumeAndAreaComeCloserAsVoxelsShrink) {
  const Sphere sphere{{0.3, -1.1, 0.7}, 20};
  double last_error = 1.0;
  for (const double voxel_mm : {2.0, 1.0, 0.5, 0.25}) {
    const Measures m = measure(combine(cube_mm(32, voxel_mm), sphere));
    const double volume = 4.0 / 3.0 * pi * 8000;
    const double area = 4.0 * pi * 400;
    // Digitised curved boundary: 0.83 h^2 sqrt(S) is the worst that spheres have shown.
    EXPECT_LE(std::abs(m.volume_mm3 - volume), 0.83 * voxel_mm * voxel_mm * std::sqrt(area))
        << voxel_mm << " mm";
    EXPECT_NEAR(m.area_crofton13_mm2 / area, 1.0, 0.02) << voxel_mm << " mm";
    ASSERT_TRUE(m.area_lindblad_mm2 && m.inertia_mm5);
    EXPECT_NEAR(*m.area_lindblad_mm2 / area, 1.0, 0.02) << voxel_mm << " mm";
    const double inertia = 0.4 * volume * 400;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR((*m.inertia_mm5)[axis][axis] / inertia, 1.0, 0.03 * voxel_mm);
      EXPECT_NEAR((*m.inertia_mm5)[axis][(axis + 1) % 3] / inertia, 0.0, 0.01 * voxel_mm);
    }
    EXPECT_NEAR(glm::distance(*m.centroid_mm, sphere.centre_mm), 0.0, 0.05 * voxel_mm);
    // Exposed faces overstate a sphere by half at every resolution: the reason why they are no area.
    const double faces = m.exposed_mm2.x + m.exposed_mm2.y + m.exposed_mm2.z;
    EXPECT_NEAR(faces / area, 1.5, 0.03);
    const double error = std::abs(m.volume_mm3 / volume - 1.0);
    EXPECT_LT(error, last_error * 1.01);
    last_error = error;
  }
}

TEST(Measure, AreaHoldsOnVoxelsThreeTimesAsHighAsWide) {
  Universe universe = cube_mm(32, 0.5);
  universe.lps_from_voxel[2][2] = 1.5;
  universe.lps_from_voxel[3][2] = -1.5 * 64 + 0.75;
  const Measures m = measure(combine(universe, Sphere{{0, 0, 0}, 25}));
  EXPECT_NEAR(m.area_crofton13_mm2 / (4 * pi * 625), 1.0, 0.02);
  EXPECT_NEAR(m.volume_mm3 / (4.0 / 3.0 * pi * 15625), 1.0, 0.003);
  // Lindblad's weights are those of cubes: no answer rather than a wrong one.
  EXPECT_FALSE(m.area_lindblad_mm2.has_value());
  EXPECT_NEAR((*m.inertia_mm5)[2][2] / (0.4 * m.volume_mm3 * 625), 1.0, 0.01);
}

TEST(Measure, ObjectsThatFillTheUniverseHaveItsOuterFaces) {
  const Universe universe{4, glm::dmat4(1.0)};
  const Measures m = measure(Octree::full(universe));
  EXPECT_DOUBLE_EQ(m.exposed_mm2.x, 2 * 256);
  EXPECT_DOUBLE_EQ(m.exposed_mm2.y, 2 * 256);
  EXPECT_DOUBLE_EQ(m.exposed_mm2.z, 2 * 256);
  EXPECT_NEAR(glm::distance(*m.centroid_mm, glm::dvec3(7.5)), 0.0, 1e-12);
}

TEST(Measure, AnEmptyObjectHasNoCentroidRatherThanAWrongOne) {
  const Measures m = measure(Octree::empty({5, glm::dmat4(1.0)}));
  EXPECT_EQ(m.volume_mm3, 0.0);
  EXPECT_FALSE(m.centroid_mm.has_value());
  EXPECT_FALSE(m.extents.has_value());
  EXPECT_FALSE(m.inertia_mm5.has_value());
}

TEST(Measure, CountsEveryNeighbouringPairOnce) {
  // Crossings of all 13 directions against a plain count, through the area they add up to.
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const tests::Dense dense = tests::random_dense(16, seed + 900);
    const Measures m = measure(tests::octree_of({4, glm::dmat4(1.0)}, dense));
    glm::dvec3 exposed(0.0);
    const auto inside = [&](const glm::ivec3& v) {
      return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
             glm::all(glm::lessThan(v, glm::ivec3(16))) && dense.at(v) != 0;
    };
    dense.for_each([&](const glm::ivec3& v) {
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          glm::ivec3 other = v;
          other[axis] += side;
          exposed[axis] += inside(v) && !inside(other);
        }
    });
    EXPECT_EQ(m.exposed_mm2, exposed);
    // Mirroring and turning the axes turns directions into each other and must not change the area.
    tests::Dense turned(16);
    dense.for_each([&](const glm::ivec3& v) { turned.at({15 - v.y, v.z, v.x}) = dense.at(v); });
    EXPECT_NEAR(measure(tests::octree_of({4, glm::dmat4(1.0)}, turned)).area_crofton13_mm2,
                m.area_crofton13_mm2, 2e-3 * m.area_crofton13_mm2);
  }
}

TEST(Measure, TheExtentsOfNothingAreNone) {
  const Universe universe = cube_mm(32, 0.5);
  EXPECT_FALSE(extents_of(Octree::empty(universe)));
  const std::optional<Box> one = extents_of(combine(universe, Box{{0, 0, 0}, {0.5, 0.5, 0.5}}));
  ASSERT_TRUE(one);
  EXPECT_EQ(one->high_mm - one->low_mm, glm::dvec3(0.5));
}

}  // namespace
}  // namespace octotomy::voxel
