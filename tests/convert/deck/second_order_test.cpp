// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/second_order.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

#include "tests/convert/cube_in_five.h"

namespace octotomy::convert {
namespace {

using tests::cube_in_five;

/// The nodes of a set behind the cube's eight, by their positions.
std::set<std::array<double, 3>> middles(const SecondOrder& made, const std::vector<std::uint32_t>& nodes) {
  std::set<std::array<double, 3>> at;
  for (const std::uint32_t node : nodes)
    if (node >= 8) {
      const glm::dvec3& p = made.tetrahedra.nodes_mm[node];
      at.insert({p.x, p.y, p.z});
    }
  return at;
}

TEST(SecondOrder, ElementsShareTheNodesOfTheirCommonSides) {
  const Tetrahedra cube = cube_in_five();
  const SecondOrder made = second_order(cube, {});
  EXPECT_EQ(made.tetrahedra.nodes_mm.size(), 8u + 12 + 6) << "a node an edge of the cube and a diagonal";
  EXPECT_EQ(made.tetrahedra.boundary_nodes.size(), 26u) << "each of them lies on the surface";
  EXPECT_EQ(made.tetrahedra.tets, cube.tets);
  for (std::size_t t = 0; t < cube.tets.size(); ++t)
    for (std::size_t i = 0; i < 6; ++i) {
      const glm::dvec3 mean = 0.5 * (cube.nodes_mm[cube.tets[t].at(sides_of_tet.at(i).first)] +
                                     cube.nodes_mm[cube.tets[t].at(sides_of_tet.at(i).second)]);
      EXPECT_EQ(made.tetrahedra.nodes_mm[made.tetrahedra.mid_nodes[t].at(i)], mean);
    }
  EXPECT_THROW(second_order(made.tetrahedra, {}), std::invalid_argument);
}

TEST(SecondOrder, AFacesMiddlesFollowItsCorners) {
  const Tetrahedra t = second_order(cube_in_five(), {}).tetrahedra;
  for (std::uint32_t tet = 0; tet < t.tets.size(); ++tet)
    for (std::uint8_t opposite = 0; opposite < 4; ++opposite) {
      const auto corners = corners_of(t, {tet, opposite});
      const auto between = middles_of(t, {tet, opposite});
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(t.nodes_mm[between.at(i)],
                  0.5 * (t.nodes_mm[corners.at(i)] + t.nodes_mm[corners.at((i + 1) % 3)]));
    }
}

TEST(SecondOrder, ASetOfASurfaceTakesTheMiddlesOfItsTrianglesAlone) {
  Tetrahedra cube = cube_in_five();
  DeckOptions options;
  // The lower face; three corners that belong to no triangle of the surface, of the element in the middle.
  options.node_sets = {{"LOW", {0, 1, 2, 3}}, {"THREE", {1, 2, 4}}, {"ONE", {7}}};
  options.prescribed = {{"LOW", {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}, {2, 4, 0}}}, {"ONE", {}}};
  const SecondOrder made = second_order(cube, options);
  const auto& sets = made.options.node_sets;
  EXPECT_TRUE(std::is_sorted(sets[0].nodes.begin(), sets[0].nodes.end()));
  EXPECT_EQ(
      middles(made, sets[0].nodes),
      (std::set<std::array<double, 3>>{{0.5, 0, 0}, {0, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}, {0.5, 0.5, 0}}));
  EXPECT_TRUE(middles(made, sets[1].nodes).empty()) << "their triangle lies within";
  EXPECT_EQ(sets[2].nodes.size(), 1u);
  ASSERT_EQ(made.options.prescribed[0].displacement_mm.size(), sets[0].nodes.size());
  for (std::size_t i = 0; i < sets[0].nodes.size(); ++i) {
    const glm::dvec3& p = made.tetrahedra.nodes_mm[sets[0].nodes[i]];
    EXPECT_EQ(made.options.prescribed[0].displacement_mm[i], glm::dvec3(2 * p.x, 4 * p.y, 0)) << "linear";
  }
  EXPECT_TRUE(made.options.prescribed[1].displacement_mm.empty()) << "what is held stays held";
}

TEST(SecondOrder, ASetWithinAndOneOfAnInterfaceTakeTheirs) {
  Tetrahedra cube = cube_in_five();
  // A node in the middle of the fifth element, which thus becomes four elements.
  cube.nodes_mm.emplace_back(0.5, 0.5, 0.5);
  cube.tets.pop_back();
  for (const std::array<std::uint32_t, 4>& tet :
       {std::array<std::uint32_t, 4>{1, 2, 4, 8}, {1, 7, 2, 8}, {1, 4, 7, 8}, {2, 7, 4, 8}})
    cube.tets.push_back(tet);
  ASSERT_GT(quality(cube).min_volume_mm3, 0.0);
  cube.boundary_nodes = boundary_nodes(cube.tets);
  cube.region_of_tet = {0, 1, 1, 1, 1, 1, 1, 1};
  DeckOptions options;
  options.node_sets = {{"BETWEEN", {1, 2, 4}}, {"WITHIN", {1, 2, 4, 8}}};
  const SecondOrder made = second_order(cube, options);
  EXPECT_EQ(made.options.node_sets[0].nodes.size(), 3u + 3);
  EXPECT_EQ(made.options.node_sets[1].nodes.size(), 4u + 6);
}

}  // namespace
}  // namespace octotomy::convert
