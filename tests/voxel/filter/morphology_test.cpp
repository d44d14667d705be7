// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/morphology.h"

#include <gtest/gtest.h>

#include "tests/voxel/dense.h"
#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

// The voxels whose ball, on an infinite lattice, holds a `wanted` voxel.
template <typename Wanted>
tests::Dense swept(int side, const glm::dvec3& spacing_mm, double radius_mm, const Wanted& wanted) {
  tests::Dense result(side);
  const glm::ivec3 reach(glm::ceil(radius_mm / spacing_mm));
  result.for_each([&](const glm::ivec3& v) {
    for (int z = -reach.z; z <= reach.z; ++z)
      for (int y = -reach.y; y <= reach.y; ++y)
        for (int x = -reach.x; x <= reach.x; ++x) {
          const glm::dvec3 d = glm::dvec3(x, y, z) * spacing_mm;
          if (glm::dot(d, d) <= radius_mm * radius_mm * (1 + 1e-12) && wanted(v + glm::ivec3(x, y, z)))
            result.at(v) = 1;
        }
  });
  return result;
}

bool in_lattice(const tests::Dense& dense, const glm::ivec3& v) {
  return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
         glm::all(glm::lessThan(v, glm::ivec3(dense.side))) && dense.at(v) != 0;
}

TEST(Morphology, AgreesWithBallsDrawnVoxelByVoxel) {
  int changed = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int side = 16;
    const glm::dvec3 spacing_mm = seed % 2 == 0 ? glm::dvec3(1) : glm::dvec3(0.7, 1.3, 2.1);
    const double radius_mm = 0.5 * static_cast<double>(seed % 7);
    const Universe universe = tests::spaced_universe(4, spacing_mm, glm::dvec3(0.0));
    const tests::Dense dense = tests::random_dense(side, seed + 300);
    const Octree octree = tests::octree_of(universe, dense);
    const tests::Dense dilated =
        swept(side, spacing_mm, radius_mm, [&](const glm::ivec3& v) { return in_lattice(dense, v); });
    tests::Dense eroded =
        swept(side, spacing_mm, radius_mm, [&](const glm::ivec3& v) { return !in_lattice(dense, v); });
    for (std::uint8_t& voxel : eroded.voxels) voxel ^= 1;
    EXPECT_TRUE(dilate(octree, radius_mm) == tests::octree_of(universe, dilated));
    EXPECT_TRUE(erode(octree, radius_mm) == tests::octree_of(universe, eroded));
    changed += dilated.voxels != dense.voxels && eroded.voxels != dense.voxels;
    // Opening is the union of the balls that fit inside.
    const tests::Dense opened =
        swept(side, spacing_mm, radius_mm, [&](const glm::ivec3& v) { return in_lattice(eroded, v); });
    EXPECT_TRUE(open(octree, radius_mm) == tests::octree_of(universe, opened));
    // Closing on a lattice without end: the object in the middle of one thrice as wide.
    if (seed % 4 == 0) {
      tests::Dense wide(3 * side);
      dense.for_each([&](const glm::ivec3& v) { wide.at(v + side) = dense.at(v); });
      const tests::Dense wide_dilated =
          swept(3 * side, spacing_mm, radius_mm, [&](const glm::ivec3& v) { return in_lattice(wide, v); });
      const tests::Dense open_again = swept(
          3 * side, spacing_mm, radius_mm, [&](const glm::ivec3& v) { return !in_lattice(wide_dilated, v); });
      tests::Dense closed(side);
      closed.for_each([&](const glm::ivec3& v) { closed.at(v) = open_again.at(v + side) == 0; });
      EXPECT_TRUE(close(octree, radius_mm) == tests::octree_of(universe, closed));
    }
  }
  EXPECT_GT(changed, 10);
}

TEST(Morphology, ABallDilatedAndErodedIsTheBallThatItsRadiusSays) {
  const Universe universe = universe_around({glm::dvec3(-16), glm::dvec3(16)}, 0.5);
  const Octree ball = combine(universe, Sphere{{0, 0, 0}, 9});
  const double larger = 4.0 / 3.0 * 3.14159265358979 * 12 * 12 * 12;
  EXPECT_NEAR(static_cast<double>(dilate(ball, 3).voxel_count()) / 8 / larger, 1.0, 0.05);
  EXPECT_TRUE(erode(ball, 10).is_empty());
  EXPECT_TRUE(open(ball, 0.0) == ball);
  EXPECT_THROW(dilate(ball, -1), std::invalid_argument);
}

TEST(Morphology, FillsCavitiesButNotTunnelsNorDents) {
  const Universe universe = universe_around({glm::dvec3(-16), glm::dvec3(16)}, 1);
  const Octree shell = combine(universe, Expression(Sphere{{0, 0, 0}, 12}) - Sphere{{0, 0, 0}, 8});
  const Octree ball = combine(universe, Sphere{{0, 0, 0}, 12});
  EXPECT_TRUE(fill_cavities(shell) == ball);
  const Octree pierced = combine(universe, Expression(shell) - Expression(Box{{-2, -2, 0}, {2, 2, 16}}));
  EXPECT_TRUE(fill_cavities(pierced) == pierced);
  EXPECT_TRUE(fill_cavities(Octree::full(universe)) == Octree::full(universe));
  EXPECT_TRUE(fill_cavities(Octree::empty(universe)).is_empty());
}

}  // namespace
}  // namespace octotomy::voxel
