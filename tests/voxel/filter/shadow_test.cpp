// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/shadow.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using std::numbers::pi;

const glm::dvec3 askew = glm::normalize(glm::dvec3(1.0, -2.0, 0.5));

Shadow shadow_of(const Universe& universe, const Expression& solid, const glm::dvec3& direction,
                 double end_mm) {
  return shadow(combine(universe, solid), solid, {direction, end_mm});
}
double volume_mm3(const Universe& universe, const Expression& solid) {
  return static_cast<double>(combine(universe, solid).voxel_count()) * universe.lattice().voxel_mm3();
}

TEST(VoxelShadow, OfABallIsItsHalfAndARoundPost) {
  for (const glm::dvec3& spacing_mm : {glm::dvec3(1.0), glm::dvec3(0.5), glm::dvec3(0.7, 1.1, 1.6)}) {
    const Universe universe = tests::spaced_universe(spacing_mm.x == 0.5 ? 7 : 6, spacing_mm);
    const glm::dvec3 centre_mm = universe.lattice().lps_mm(glm::dvec3(0.5 * universe.side())) + 0.21;
    const double radius_mm = 10.0;
    const Expression ball(Sphere{centre_mm, radius_mm});
    for (const glm::dvec3& direction : {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1), askew, -askew}) {
      const double end_mm = glm::dot(centre_mm, direction) + radius_mm;
      const Shadow made = shadow_of(universe, ball, direction, end_mm);
      const double truth_mm3 = (2.0 / 3.0 + 1.0) * pi * std::pow(radius_mm, 3.0);
      const double area_mm2 = (2.0 + 2.0 + 1.0) * pi * radius_mm * radius_mm;
      // Three deviations of a count, and the flat end, which lies anywhere between planes of voxels' middles.
      const bool is_along_axis = direction != askew && direction != -askew;
      const double allowed_mm3 =
          3.0 * 0.32 * std::pow(spacing_mm.z, 2.0) * std::sqrt(area_mm2) +
          0.5 * spacing_mm.z / (is_along_axis ? 1.0 : std::sqrt(21.0)) * pi * radius_mm * radius_mm;
      EXPECT_NEAR(volume_mm3(universe, Expression(made.window)), truth_mm3, allowed_mm3)
          << direction.x << ' ' << direction.y << ' ' << direction.z << ", voxels of " << spacing_mm.x;
      EXPECT_NEAR(made.far_end_mm, end_mm, 0.5 * glm::length(spacing_mm));
      EXPECT_LE(made.far_end_mm, end_mm + 0.02 * glm::length(spacing_mm));
    }
  }
}

TEST(VoxelShadow, OfAMushroomFillsBelowItsCapButNotAboveIt) {
  const Universe universe = tests::spaced_universe(6);
  const glm::dvec3 m_mm = universe.lattice().lps_mm(glm::dvec3(32.0)) + 0.45;
  const Expression cap(Box{m_mm + glm::dvec3(-9, -9, 4), m_mm + glm::dvec3(9, 9, 8)}),
      stem(Box{m_mm + glm::dvec3(-3, -3, -8), m_mm + glm::dvec3(3, 3, 4.5)});
  const Expression mushroom = cap | stem;
  const Shadow above = shadow_of(universe, mushroom, {0, 0, -1}, 8.0 - m_mm.z);
  EXPECT_EQ(volume_mm3(universe, Expression(above.window)), 18 * 18 * 16);
  const Shadow below = shadow_of(universe, mushroom, {0, 0, 1}, 8.0 + m_mm.z);
  EXPECT_EQ(volume_mm3(universe, Expression(below.window)), volume_mm3(universe, mushroom));
  // The shadow of a shadow is the same but for rounded edges between voxels.
  const Expression once(above.window);
  const Shadow twice = shadow_of(universe, once, {0, 0, -1}, 8.0 - m_mm.z);
  EXPECT_NEAR(volume_mm3(universe, Expression(twice.window)), 18 * 18 * 16, 1e-3 * 18 * 18 * 16);
}

TEST(VoxelShadow, ASlabAlongAnObliqueDirectionIsFilledDownToTheEnd) {
  const Universe universe = tests::spaced_universe(7, glm::dvec3(0.5));
  // Faces lie between voxels: else all of a face is rounded alike.
  const glm::dvec3 m_mm = universe.lattice().lps_mm(glm::dvec3(64.0)) + 0.25;
  const Expression slab(Box{m_mm - glm::dvec3(8, 8, 1.5), m_mm + glm::dvec3(8, 8, 1.5)});
  const double end_mm = glm::dot(m_mm, askew) + 16.0;
  const Shadow made = shadow_of(universe, slab, askew, end_mm);
  // The silhouette's area times the way from the front to the end, on the mean over the silhouette: from the
  // middle of the box to the end, and half the box's own depth in each line of sight.
  const glm::dvec3 n = glm::abs(askew), a(16.0, 16.0, 3.0);
  const double silhouette_mm2 = n.x * a.y * a.z + n.y * a.z * a.x + n.z * a.x * a.y;
  const double truth_mm3 = silhouette_mm2 * 16.0 + 0.5 * a.x * a.y * a.z;
  EXPECT_NEAR(volume_mm3(universe, Expression(made.window)), truth_mm3, 0.006 * truth_mm3);
}

TEST(VoxelShadow, OfATipThinnerThanAVoxelIsTheColumnBehindIt) {
  const Universe universe = tests::spaced_universe(5);
  const glm::dvec3 at_mm = universe.lattice().lps_mm(glm::dvec3(16.0));
  const Expression speck(Sphere{at_mm, 0.3});
  const Octree octree = combine(universe, speck);
  ASSERT_EQ(octree.voxel_count(), 1U);
  const Shadow made = shadow(octree, speck, {{0, 1, 0}, at_mm.y + 10.25});
  const Octree behind = combine(universe, Expression(made.window));
  EXPECT_EQ(behind.voxel_count(), 11U);
  for (int y = 0; y <= 10; ++y) EXPECT_TRUE(behind.contains({16, 16 + y, 16})) << y;
}

TEST(VoxelShadow, WhatItAddsIsKnownForManyDirectionsAtOnce) {
  const Universe universe = tests::spaced_universe(6);
  const Expression ball(Sphere{universe.lattice().lps_mm(glm::dvec3(31.3)), 12.0});
  const std::vector<double> filled =
      filled_mm3(combine(universe, ball), ball, {askew, glm::dvec3(0, 0, 1), -askew});
  ASSERT_EQ(filled.size(), 3u);
  const double truth_mm3 = pi / 3.0 * 12.0 * 12.0 * 12.0;
  for (const double mm3 : filled) EXPECT_NEAR(mm3, truth_mm3, 0.03 * truth_mm3);
  EXPECT_THROW(filled_mm3(combine(universe, ball), ball, {glm::dvec3(0, 0, 2)}), std::invalid_argument);
}

TEST(VoxelShadow, TheSameBitsOnOneThreadAndMany) {
  const Universe universe = tests::spaced_universe(6);
  const Expression ball(Sphere{universe.lattice().lps_mm(glm::dvec3(31.3)), 12.0});
  const auto made = [&] {
    return combine(universe, Expression(shadow_of(universe, ball, askew, 1e3).window));
  };
  const Octree many = made();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(made(), many);
}

TEST(VoxelShadow, RefusesADirectionWithoutLengthAndAnObjectWithoutVoxels) {
  const Universe universe = tests::spaced_universe(5);
  const Expression ball(Sphere{universe.lattice().lps_mm(glm::dvec3(16.0)), 6.0});
  EXPECT_THROW(shadow_of(universe, ball, {0, 0, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(shadow_of(universe, ball, {0, 3, 0}, 0.0), std::invalid_argument);
  EXPECT_THROW(shadow_of(universe, ball, {0, 1, 0}, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_THROW(shadow(Octree::empty(universe), ball, {{0, 1, 0}, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
