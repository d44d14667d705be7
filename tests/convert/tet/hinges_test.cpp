// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/hinges.h"

#include <gtest/gtest.h>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/unit_universe.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

voxel::Box cuboid(const glm::dvec3& low, const glm::dvec3& high) {
  return {low - 0.5, high - 0.5};
}

Tetrahedra elements_of(const voxel::Box& one, const voxel::Box& other) {
  return tetrahedra_of(
      voxel::combine(tests::unit_universe(4), voxel::Expression(one) | voxel::Expression(other)));
}

TEST(Hinges, OfBlocksThatShareAnEdgeAreReportedWithTheirPlace) {
  const auto hinge = hinge_in(elements_of(cuboid({1, 1, 1}, {4, 4, 4}), cuboid({4, 4, 1}, {7, 7, 4})));
  ASSERT_TRUE(hinge);
  EXPECT_NE(hinge->find("2 parts are connected only by edges or nodes"), std::string::npos) << *hinge;
  EXPECT_NE(hinge->find("(4, 4, "), std::string::npos) << *hinge;
}

TEST(Hinges, OfBlocksThatShareACornerAreOneNode) {
  const auto hinge = hinge_in(elements_of(cuboid({1, 1, 1}, {4, 4, 4}), cuboid({4, 4, 4}, {7, 7, 7})));
  ASSERT_TRUE(hinge);
  EXPECT_NE(hinge->find("at 1 node, at (4, 4, 4) mm"), std::string::npos) << *hinge;
}

TEST(Hinges, AreNoneWhereBlocksShareAFaceOrNothing) {
  EXPECT_FALSE(hinge_in(elements_of(cuboid({1, 1, 1}, {4, 4, 4}), cuboid({4, 3, 1}, {7, 7, 4}))));
  EXPECT_FALSE(hinge_in(elements_of(cuboid({1, 1, 1}, {4, 4, 4}), cuboid({6, 6, 6}, {9, 9, 9}))));
}

TEST(Hinges, AreNoneWhereTwoBlocksThatShareAnEdgeAreLinkedElsewhere) {
  Tetrahedra ring = tetrahedra_of(
      voxel::combine(tests::unit_universe(4), voxel::Expression(cuboid({1, 1, 1}, {4, 4, 4})) |
                                                  voxel::Expression(cuboid({4, 4, 1}, {7, 7, 4})) |
                                                  voxel::Expression(cuboid({1, 1, 4}, {7, 7, 6}))));
  EXPECT_FALSE(hinge_in(ring));
}

}  // namespace
}  // namespace octotomy::convert
