// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/separate_regions.h"

#include <gtest/gtest.h>

#include "convert/deck/deck.h"
#include "convert/deck/second_order.h"
#include "convert/tet/octree_tetrahedra.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// Two blocks of 4 x 4 x 4 voxels, one upon the other.
Tetrahedra two_blocks() {
  const voxel::Universe universe = tests::unit_universe(3);
  return tetrahedra_of(
      {voxel::combine(universe, voxel::Expression(voxel::Box{{-0.5, -0.5, -0.5}, {3.5, 3.5, 3.5}})),
       voxel::combine(universe, voxel::Expression(voxel::Box{{-0.5, -0.5, 3.5}, {3.5, 3.5, 7.5}}))},
      BoundaryCells::Voxels);
}

TEST(SeparateRegions, EachRegionHasNodesOfItsOwnInTheSamePlaces) {
  const Tetrahedra shared = two_blocks();
  ASSERT_EQ(interfaces(shared).size(), 1u);
  const Tetrahedra apart = separate_regions(shared);
  EXPECT_TRUE(interfaces(apart).empty());
  EXPECT_EQ(apart.nodes_mm.size(), shared.nodes_mm.size() + 25) << "5 x 5 corners between the blocks";
  EXPECT_EQ(apart.boundary_nodes.size(), shared.boundary_nodes.size() + 25 + 9)
      << "copies, and those within the interface that the outside did not have";
  for (std::size_t t = 0; t < shared.tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(apart.nodes_mm[apart.tets[t].at(i)], shared.nodes_mm[shared.tets[t].at(i)]);
}

TEST(SeparateRegions, BothSidesOfAnInterfaceFaceEachOther) {
  const Tetrahedra shared = two_blocks();
  const Interface between = interfaces(shared).front();
  ASSERT_EQ(between.faces.size(), between.opposite.size());
  const Tetrahedra apart = separate_regions(shared);
  for (std::size_t f = 0; f < between.faces.size(); ++f) {
    const auto normal = [&](const ElementFace& face) {
      const auto [a, b, c] = corners_of(apart, face);
      return glm::cross(apart.nodes_mm[b] - apart.nodes_mm[a], apart.nodes_mm[c] - apart.nodes_mm[a]);
    };
    EXPECT_GT(normal(between.faces[f]).z, 0.0) << "up from the lower block";
    EXPECT_EQ(normal(between.faces[f]), -normal(between.opposite[f]));
  }
}

/// Two blocks upon each other, and a third beside both.
Tetrahedra blocks_with_a_neighbour() {
  const voxel::Universe universe = tests::unit_universe(3);
  const auto block = [&](const glm::dvec3& low, const glm::dvec3& high) {
    return voxel::combine(universe, voxel::Expression(voxel::Box{low, high}));
  };
  return tetrahedra_of({block({-0.5, -0.5, -0.5}, {3.5, 3.5, 3.5}), block({-0.5, -0.5, 3.5}, {3.5, 3.5, 7.5}),
                        block({3.5, -0.5, -0.5}, {7.5, 3.5, 7.5})},
                       BoundaryCells::Voxels);
}

TEST(SeparateRegions, ASlitBetweenTwoEndsWhereAThirdHoldsBoth) {
  const Tetrahedra shared = blocks_with_a_neighbour();
  const Tetrahedra apart = separate_regions(shared, {{1, 0}});
  EXPECT_EQ(apart.nodes_mm.size(), shared.nodes_mm.size() + 20)
      << "of 5 x 5 corners between the blocks, five lie on the third";
  ASSERT_EQ(interfaces(apart).size(), 2u) << "both still share the third's";
  for (const Interface& between : interfaces(apart)) {
    EXPECT_EQ(between.to, 2u);
    EXPECT_EQ(between.faces.size(), interfaces(shared)[between.from + 1].faces.size());
  }
}

TEST(SeparateRegions, EveryPairApartIsAllApartAndNoPairIsNone) {
  const Tetrahedra shared = blocks_with_a_neighbour();
  const Tetrahedra all = separate_regions(shared);
  const Tetrahedra each = separate_regions(shared, {{0, 1}, {0, 2}, {1, 2}});
  EXPECT_EQ(each.tets, all.tets);
  EXPECT_EQ(each.nodes_mm, all.nodes_mm);
  EXPECT_EQ(separate_regions(shared, {}).tets, shared.tets);
}

TEST(SeparateRegions, OneRegionStaysAsItIsAndMiddlesComeAfter) {
  const Tetrahedra shared = two_blocks();
  Tetrahedra one = shared;
  one.region_of_tet.clear();
  EXPECT_EQ(separate_regions(one).nodes_mm, shared.nodes_mm);
  EXPECT_THROW(separate_regions(second_order(shared, {}).tetrahedra), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::convert
