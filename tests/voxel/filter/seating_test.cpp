// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/seating.h"

#include <gtest/gtest.h>

#include "tests/voxel/spaced_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

TEST(VoxelSeating, ABumpReachesIntoTheWayByWhatItSticksOut) {
  const Universe universe = tests::spaced_universe(7, glm::dvec3(0.25));
  const glm::dvec3 m_mm = universe.lattice().lps_mm(glm::dvec3(64.0)) + 0.05;
  const auto box = [&](const glm::dvec3& low, const glm::dvec3& high) {
    return Expression(Box{m_mm + low, m_mm + high});
  };
  const Expression block = box({-5, -5, -5}, {5, 5, 5}) | box({5, -2, -1}, {7, 2, 1});
  const Octree object = combine(universe, block);
  const double diagonal_mm = glm::length(glm::dvec3(0.25));
  for (const double leg_mm : {5.5, 6.0, 7.5}) {
    const Expression clamp = box({-6, -4, 5.5}, {11, 4, 8}) | box({leg_mm, -4, -6}, {leg_mm + 4.0, 4, 5.5});
    const Seating found = seating(combine(universe, clamp), clamp, object, {{0, 0, -1}});
    EXPECT_EQ(found.binding.has_value(), leg_mm < 7.0) << leg_mm;
    if (!found.binding) continue;
    EXPECT_NEAR(found.binding->depth_mm, 7.0 - leg_mm, diagonal_mm) << leg_mm;
    EXPECT_NEAR(found.binding->at_mm.x, m_mm.x + 7.0, diagonal_mm) << leg_mm;
    EXPECT_LT(std::abs(found.binding->at_mm.z - m_mm.z), 1.0 + diagonal_mm) << leg_mm;
  }
}

TEST(VoxelSeating, AChannelThinnerThanAVoxelLetsATipPass) {
  const Universe universe = tests::spaced_universe(5);
  const glm::dvec3 at_mm = universe.lattice().lps_mm(glm::dvec3(16.0));
  const Expression speck(Sphere{at_mm, 0.3}), block(Box{at_mm - 5.3, at_mm + 5.3}),
      channel(Cylinder{at_mm - glm::dvec3(0, 9, 0), at_mm + glm::dvec3(0, 9, 0), 0.45});
  const Octree object = combine(universe, speck);
  const Expression pierced = block - channel;
  EXPECT_FALSE(seating(combine(universe, pierced), pierced, object, {{0, 1, 0}}).binding);
  EXPECT_TRUE(seating(combine(universe, block), block, object, {{0, 1, 0}}).binding);
}

}  // namespace
}  // namespace octotomy::voxel
