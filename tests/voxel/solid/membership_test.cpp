// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/membership.h"

#include <gtest/gtest.h>

#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {
namespace {

using tests::unit_universe;

TEST(Membership, AgreesWithCombineAtTheCentresOfVoxels) {
  const Universe universe = unit_universe(5);
  const Octree board =
      combine(universe, Expression(Box{{2, 3, 4}, {20, 21, 22}}) ^ Sphere{{16, 16, 16}, 9.1});
  const Region region{parse_view("25,40"), {{{-20, -20}, {20, -21}, {22, 20}, {-21, 23}}}};
  const glm::dmat4 motion =
      moved_from_still({.translate_mm = {1.25, 2, 3}, .degrees = 20, .axis = {1, 2, 3}});
  const Expression solid = ((Expression(board) | moved(Torus{{12, 14, 15}, {0, 0, 1}, 7, 2.2}, motion)) -
                            HalfSpace{{0, 0.6, -0.8}, -6.3}) ^
                           (Expression(RegionMask{{region}}) & Cylinder{{3, 4, 5}, {25, 24, 20}, 4.1});
  const Octree voxels = combine(universe, solid);
  const Membership inside(universe, solid);
  int wrong = 0;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        wrong += inside(universe.lattice().lps_mm({x, y, z})) != voxels.contains({x, y, z});
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(voxels.voxel_count(), 1000U);
}

TEST(Membership, AWindowEndsBetweenItsSamplesAndWithItsScan) {
  const Universe universe = unit_universe(4);
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples;
  for (int i = 0; i < 16 * 16 * 16; ++i) samples.push_back(static_cast<std::int16_t>(100 * (i % 16)));
  scene.samples = samples;
  const Membership inside(universe, Window{grey_octree_of(universe, scene), 150, 32767});
  EXPECT_TRUE(inside(universe.lattice().lps_mm({1.51, 8, 8})));
  EXPECT_FALSE(inside(universe.lattice().lps_mm({1.49, 8, 8})));
  const Membership air(universe, Window{grey_octree_of(universe, scene), -1024, 50});
  EXPECT_TRUE(air(universe.lattice().lps_mm({-0.49, 8, 8})));
  EXPECT_FALSE(air(universe.lattice().lps_mm({-0.51, 8, 8})));
}

}  // namespace
}  // namespace octotomy::voxel
