// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/improve_tetrahedra.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// A ball of an octree's elements, every dihedral angle of which is at least 30 degrees.
Tetrahedra good_ball() {
  const voxel::Universe universe = tests::unit_universe(4);
  return tetrahedra_of(voxel::combine(universe, voxel::Expression(voxel::Sphere{glm::dvec3(7.5), 6.0})),
                       BoundaryCells::Voxels);
}

/// The nodes that are not on the surface, each moved towards a neighbour until its elements are nearly flat.
Tetrahedra spoiled(Tetrahedra t) {
  std::vector<bool> fixed(t.nodes_mm.size(), false);
  for (const std::uint32_t v : t.boundary_nodes) fixed[v] = true;
  for (const auto& tet : t.tets) {
    if (fixed[tet[3]]) continue;
    const glm::dvec3 foot = (t.nodes_mm[tet[0]] + t.nodes_mm[tet[1]] + t.nodes_mm[tet[2]]) / 3.0;
    t.nodes_mm[tet[3]] += 0.97 * (foot - t.nodes_mm[tet[3]]);
    for (const std::uint32_t v : tet) fixed[v] = true;
  }
  return t;
}

TEST(ImproveTetrahedra, NodesMovedNearlyIntoAFaceComeBackAndTheSurfaceStaysToTheBit) {
  const Tetrahedra before = spoiled(good_ball());
  const double spoiled_deg = quality(before).min_dihedral_deg;
  ASSERT_LT(spoiled_deg, 5.0);
  ASSERT_GT(quality(before).min_volume_mm3, 0.0);
  Tetrahedra after = before;
  improve(after, {.min_dihedral_deg = 20.0, .rounds = 20});
  EXPECT_GE(quality(after).min_dihedral_deg, 20.0);
  EXPECT_GT(quality(after).min_volume_mm3, 0.0);
  EXPECT_EQ(after.tets, before.tets);
  for (const std::uint32_t v : before.boundary_nodes) EXPECT_EQ(after.nodes_mm[v], before.nodes_mm[v]);
  EXPECT_NEAR(quality(after).volume_mm3, quality(before).volume_mm3, 1e-9 * quality(before).volume_mm3);
}

TEST(ImproveTetrahedra, NodesOfTheSurfaceMoveByNoMoreThanTheirPlay) {
  // A sliver: four corners of a square, two of them lifted by a hundredth.
  Tetrahedra sliver;
  sliver.nodes_mm = {{0, 0, 0}, {1, 0, 0.01}, {0, 1, 0.01}, {1, 1, 0}};
  sliver.tets = {{0, 2, 1, 3}};
  if (six_volumes(corners_mm(sliver, 0)) < 0.0) std::swap(sliver.tets[0][0], sliver.tets[0][1]);
  sliver.boundary_nodes = {0, 1, 2, 3};
  ASSERT_LT(quality(sliver).min_dihedral_deg, 2.0);

  Tetrahedra held = sliver;
  improve(held, {});
  EXPECT_EQ(held.nodes_mm, sliver.nodes_mm);

  Tetrahedra moved = sliver;
  improve(moved, {.min_dihedral_deg = 10.0, .surface_play_mm = std::vector<double>(4, 0.05)});
  EXPECT_GT(quality(moved).min_dihedral_deg, 2.0 * quality(sliver).min_dihedral_deg);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_LE(glm::distance(moved.nodes_mm[v], sliver.nodes_mm[v]), 0.05);
}

TEST(ImproveTetrahedra, WhatIsGoodEnoughIsLeftAloneToTheBit) {
  const Tetrahedra before = good_ball();
  Tetrahedra after = before;
  improve(after, {.min_dihedral_deg = 25.0,
                  .surface_play_mm = std::vector<double>(after.boundary_nodes.size(), 1.0),
                  .rounds = 3});
  EXPECT_EQ(after.nodes_mm, before.nodes_mm);
}

TEST(ImproveTetrahedra, AnElementInsideOutIsTurnedRightWhereItsNodesAllowIt) {
  Tetrahedra t = good_ball();
  std::vector<bool> fixed(t.nodes_mm.size(), false);
  for (const std::uint32_t v : t.boundary_nodes) fixed[v] = true;
  const auto inner =
      std::find_if(t.tets.begin(), t.tets.end(), [&](const auto& tet) { return !fixed[tet[3]]; });
  ASSERT_NE(inner, t.tets.end());
  const glm::dvec3 foot = (t.nodes_mm[(*inner)[0]] + t.nodes_mm[(*inner)[1]] + t.nodes_mm[(*inner)[2]]) / 3.0;
  t.nodes_mm[(*inner)[3]] += 1.1 * (foot - t.nodes_mm[(*inner)[3]]);
  ASSERT_LT(quality(t).min_volume_mm3, 0.0);
  improve(t, {});
  EXPECT_GT(quality(t).min_volume_mm3, 0.0);
}

TEST(ImproveTetrahedra, WhatHasNoHopeEndsEarlyAndMayBeGoneOnWith) {
  Tetrahedra pressed = spoiled(good_ball());
  for (glm::dvec3& node_mm : pressed.nodes_mm) node_mm.z *= 0.05;
  constexpr int rounds = 4;
  Tetrahedra whole = pressed, parted = pressed;
  EXPECT_EQ(improve(whole, {.rounds = rounds}), 0);
  const int left = improve(parted, {.rounds = rounds, .all_or_nothing = true});
  ASSERT_EQ(left, rounds - 1);
  EXPECT_TRUE(parted.nodes_mm != whole.nodes_mm);
  improve(parted, {.rounds = left});
  EXPECT_TRUE(parted.nodes_mm == whole.nodes_mm);

  Tetrahedra mended = spoiled(good_ball());
  EXPECT_EQ(improve(mended, {.min_dihedral_deg = 20.0, .rounds = 20, .all_or_nothing = true}), 0);
  EXPECT_GE(quality(mended).min_dihedral_deg, 20.0);
}

TEST(ImproveTetrahedra, RefusesOptionsOutOfRange) {
  Tetrahedra t = good_ball();
  EXPECT_THROW(improve(t, {.min_dihedral_deg = 61.0}), std::invalid_argument);
  EXPECT_THROW(improve(t, {.surface_play_mm = std::vector<double>(t.boundary_nodes.size(), -1.0)}),
               std::invalid_argument);
  EXPECT_THROW(improve(t, {.surface_play_mm = {1.0}}), std::invalid_argument);
  EXPECT_THROW(improve(t, {.rounds = 0}), std::invalid_argument);
  EXPECT_THROW(improve(t, {.surface_play_mm = std::vector<double>(t.boundary_nodes.size(), 1.0),
                           .all_or_nothing = true}),
               std::invalid_argument);
}

TEST(ImproveTetrahedra, FlatFacesOfTheSurfaceStayFlatWhereItsNodesHavePlay) {
  // A cube of an octree's elements, a node of each side moved nearly onto a neighbour in its plane.
  const voxel::Universe universe = tests::unit_universe(3);
  Tetrahedra cube = tetrahedra_of(
      voxel::combine(universe, voxel::Expression(voxel::OrientedBox{glm::dvec3(3.5), glm::dvec3(2.0)})),
      BoundaryCells::Voxels);
  glm::dvec3 low(1e9), high(-1e9);
  for (const std::uint32_t v : cube.boundary_nodes) {
    low = glm::min(low, cube.nodes_mm[v]);
    high = glm::max(high, cube.nodes_mm[v]);
  }
  const auto sides_of = [&](const glm::dvec3& p) {
    std::array<int, 3> sides{};
    for (int axis = 0; axis < 3; ++axis)
      sides.at(static_cast<std::size_t>(axis)) = p[axis] == low[axis] ? -1 : p[axis] == high[axis] ? 1 : 0;
    return sides;
  };
  // In the middle of each side, so that it may slide back.
  for (const std::uint32_t v : cube.boundary_nodes) {
    const std::array<int, 3> sides = sides_of(cube.nodes_mm[v]);
    const glm::dvec3 off = glm::abs(cube.nodes_mm[v] - 0.5 * (low + high));
    const int axis = sides[0] != 0 ? 0 : sides[1] != 0 ? 1 : 2;
    const int along = (axis + 1) % 3, across = (axis + 2) % 3;
    if (sides.at(static_cast<std::size_t>(axis)) != 0 && off[along] < 0.6 && off[across] < 0.6)
      cube.nodes_mm[v][along] += 0.45;
  }
  const Tetrahedra given = cube;
  ImproveOptions options;
  options.min_dihedral_deg = 40.0;
  options.rounds = 4;
  options.surface_play_mm.assign(cube.boundary_nodes.size(), 0.3);
  improve(cube, options);
  std::size_t moved = 0;
  for (const std::uint32_t v : cube.boundary_nodes) {
    moved += cube.nodes_mm[v] != given.nodes_mm[v];
    const std::array<int, 3> sides = sides_of(given.nodes_mm[v]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (sides.at(axis) != 0) {
        EXPECT_NEAR(cube.nodes_mm[v][static_cast<int>(axis)], given.nodes_mm[v][static_cast<int>(axis)],
                    1e-12);
      }
  }
  EXPECT_GT(moved, 0U);
}

}  // namespace
}  // namespace octotomy::convert
