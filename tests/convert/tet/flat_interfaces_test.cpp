// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/flat_interfaces.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "convert/tet/element_faces.h"

namespace octotomy::convert {
namespace {

/// Two elements about a side from (0, 0, -1) to (0, 0, 1), which passes through z = 0.2: the first region. The
/// second one is an element above that height.
Tetrahedra about_a_side() {
  Tetrahedra t;
  t.nodes_mm = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0.2}, {0, 1, 0.2}, {-1, 0, 0.2}, {1, 1, 1.2}};
  t.tets = {{0, 2, 3, 1}, {0, 3, 4, 1}, {2, 5, 3, 1}};
  t.region_of_tet = {0, 0, 1};
  t.boundary_nodes = boundary_nodes(t.tets);
  return t;
}

FlatInterfaceOptions at_a_fifth(double least_deg) {
  FlatInterfaceOptions options;
  options.planes = {{{{0, 0, 0.2}, {0, 0, 1}}, 1, 2}};
  options.least_deg = least_deg;
  return options;
}

double volume_mm3(const Tetrahedra& t, std::uint32_t region) {
  double six = 0.0;
  for (std::size_t i = 0; i < t.tets.size(); ++i) {
    EXPECT_GT(six_volumes(corners_mm(t, i)), 0.0) << "element " << i;
    if (t.region_of_tet[i] == region) six += six_volumes(corners_mm(t, i));
  }
  return six / 6.0;
}

TEST(FlatInterfaces, SidesThroughThePlaneAreSplitAndEachPartGoesToItsSide) {
  Tetrahedra t = about_a_side();
  const double before_mm3 = volume_mm3(t, 0) + volume_mm3(t, 1);
  ASSERT_EQ(bumps(t, at_a_fifth(5.0)).size(), 1u);
  EXPECT_EQ(split_at_planes(t, at_a_fifth(5.0)), 1u);
  ASSERT_EQ(t.nodes_mm.size(), 7u);
  EXPECT_DOUBLE_EQ(t.nodes_mm[6].z, 0.2);
  ASSERT_EQ(t.tets.size(), 5u);
  // Below the plane the two elements about the side have a base of 1 mm2 and a height of 1.2 mm.
  EXPECT_NEAR(volume_mm3(t, 0), 1.2 / 3.0, 1e-12);
  EXPECT_NEAR(volume_mm3(t, 0) + volume_mm3(t, 1), before_mm3, 1e-12);
  EXPECT_TRUE(bumps(t, at_a_fifth(5.0)).empty());
  EXPECT_EQ(t.boundary_nodes, boundary_nodes(t.tets));
}

TEST(FlatInterfaces, ASideIsLeftWholeWhereAPartWouldBeUnfit) {
  Tetrahedra t = about_a_side();
  EXPECT_EQ(split_at_planes(t, at_a_fifth(50.0)), 0u);
  EXPECT_EQ(t.tets, about_a_side().tets);
  EXPECT_EQ(bumps(t, at_a_fifth(50.0)).size(), 1u);
}

TEST(FlatInterfaces, NodesGoToThePlaneUnlessAnElementWouldBeUnfit) {
  Tetrahedra t;
  t.nodes_mm = {{0, 0, -1}, {1, 0, 0}, {0, 1, 0.1}, {-1, -1, 0}, {0, 0, 1}};
  t.tets = {{0, 1, 2, 3}, {1, 3, 2, 4}};
  for (std::size_t i = 0; i < 2; ++i)
    if (six_volumes(corners_mm(t, i)) < 0.0) std::swap(t.tets[i][0], t.tets[i][1]);
  t.region_of_tet = {0, 1};
  FlatInterfaceOptions options;
  options.planes = {{{{0, 0, 0}, {0, 0, 1}}, 1, 2}};
  Tetrahedra strict = t;
  flatten_interfaces(t, options);
  EXPECT_EQ(t.nodes_mm[2], glm::dvec3(0, 1, 0));
  options.least_deg = 60.0;
  flatten_interfaces(strict, options);
  EXPECT_EQ(strict.nodes_mm[2], glm::dvec3(0, 1, 0.1));
}

TEST(FlatInterfaces, ElementsOfTheOtherSideAreGivenToIt) {
  Tetrahedra t = about_a_side();
  t.region_of_tet = {0, 0, 0};
  divide_by_planes(t, at_a_fifth(5.0).planes);
  EXPECT_EQ(t.region_of_tet[2], 0u) << "no node of it touches the other region";
  t.region_of_tet = {0, 1, 0};
  divide_by_planes(t, at_a_fifth(5.0).planes);
  EXPECT_EQ(t.region_of_tet, (std::vector<std::uint32_t>{0, 0, 1}));
}

}  // namespace
}  // namespace octotomy::convert
