// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/midline.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// A block of 4 x 4 x 4 voxels, corners from -0.5 to 3.5.
Tetrahedra block_of_64_voxels() {
  const voxel::Universe universe = tests::unit_universe(3);
  return tetrahedra_of(
      voxel::combine(universe, voxel::Expression(voxel::Box{{-0.5, -0.5, -0.5}, {3.5, 3.5, 3.5}})),
      BoundaryCells::Voxels);
}

TEST(Midline, IsTheRingOfNodesOnThePlaneWhereThereAreAny) {
  const Tetrahedra tetrahedra = block_of_64_voxels();
  const std::vector<std::uint32_t> ring = midline_nodes(tetrahedra, {1.5, 7, 7}, {-3, 0, 0});
  ASSERT_EQ(ring.size(), 16U) << "5 x 5 corners without the inner 3 x 3";
  for (const std::uint32_t node : ring) EXPECT_EQ(tetrahedra.nodes_mm[node].x, 1.5);
  EXPECT_TRUE(std::is_sorted(ring.begin(), ring.end()));
}

TEST(Midline, BesideThePlaneTheNearerNodesAreTaken) {
  const Tetrahedra tetrahedra = block_of_64_voxels();
  EXPECT_EQ(midline_nodes(tetrahedra, {1.7, 0, 0}, {1, 0, 0}),
            midline_nodes(tetrahedra, {1.5, 0, 0}, {1, 0, 0}));
  for (const std::uint32_t node : midline_nodes(tetrahedra, {2.3, 0, 0}, {1, 0, 0}))
    EXPECT_EQ(tetrahedra.nodes_mm[node].x, 2.5);
}

TEST(Midline, APlaneAlongAFaceTakesTheWholeFaceAndOneBeyondNothing) {
  const Tetrahedra tetrahedra = block_of_64_voxels();
  std::vector<std::uint32_t> face;
  for (const std::uint32_t node : tetrahedra.boundary_nodes)
    if (tetrahedra.nodes_mm[node].z == 3.5) face.push_back(node);
  EXPECT_EQ(midline_nodes(tetrahedra, {0, 0, 3.5}, {0, 0, 1}), face);
  EXPECT_TRUE(midline_nodes(tetrahedra, {0, 0, 3.6}, {0, 0, 1}).empty());
  EXPECT_THROW(midline_nodes(tetrahedra, {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::convert
