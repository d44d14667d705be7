// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/partial_octree.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "tests/voxel/field_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/digitise.h"

namespace octotomy::voxel {
namespace {

TEST(ShareSamples, AreTheFractionsAndTheirHalfIsTheVoxelsAtLeastHalfFilled) {
  for (const int depth : {3, 4, 5}) {
    const Universe universe = tests::unit_universe(depth);
    const double middle = 0.5 * (universe.side() - 1);
    const PartialOctree partial =
        digitise_partial(universe, Expression(Sphere{{middle, middle + 0.3, middle}, 0.7 * middle}));
    const GreyOctree shares = share_samples(partial);
    EXPECT_EQ(combine(universe, Expression(window_of(shares, half_share))), at_least_half(partial)) << depth;
    tests::for_each_index(universe.lattice(), 0, [&](const glm::ivec3& voxel) {
      if (!partial.touching.contains(voxel)) {
        ASSERT_EQ(shares.sample(voxel), 0);
      } else if (partial.inside.contains(voxel)) {
        ASSERT_EQ(shares.sample(voxel), 32767);
      }
    });
    std::size_t visited = 0;
    for_each_boundary_voxel(partial, [&](const glm::ivec3& voxel, std::uint16_t fraction) {
      ++visited;
      ASSERT_NEAR(shares.step() * shares.sample(voxel), fraction / double{PartialOctree::whole},
                  0.51 / 32767.0);
    });
    EXPECT_EQ(visited, partial.fractions.size());
    EXPECT_GT(visited, 20u);
  }
}

TEST(ShareSamples, OfAFullAndOfAnEmptyUniverseAreOneAndZero) {
  const Universe universe = tests::unit_universe(5);
  const GreyOctree full = share_samples({Octree::full(universe), Octree::full(universe), {}});
  const GreyOctree empty = share_samples({Octree::empty(universe), Octree::empty(universe), {}});
  tests::for_each_index(universe.lattice(), 0, [&](const glm::ivec3& voxel) {
    ASSERT_EQ(full.sample(voxel), 32767);
    ASSERT_EQ(empty.sample(voxel), 0);
  });
}

}  // namespace
}  // namespace octotomy::voxel
