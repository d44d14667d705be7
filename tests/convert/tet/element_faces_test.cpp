// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/element_faces.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>

#include "convert/tet/octree_tetrahedra.h"
#include "tests/unit_universe.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// Two touching regions of a ball.
Tetrahedra halved_ball() {
  const voxel::Universe universe = tests::unit_universe(4);
  const voxel::Octree ball = voxel::combine(universe, voxel::Sphere{{7.2, 7.6, 8.1}, 6.4});
  const voxel::Octree half =
      voxel::combine(universe, voxel::Expression(ball) & voxel::Box{{-0.5, -0.5, -0.5}, {15.5, 15.5, 6.5}});
  return tetrahedra_of({half, ball});
}

std::map<std::array<std::uint32_t, 3>, std::vector<ElementFace>> by_corners(const Tetrahedra& tetrahedra) {
  std::map<std::array<std::uint32_t, 3>, std::vector<ElementFace>> all;
  for (std::uint32_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (std::uint8_t i = 0; i < 4; ++i) {
      std::array<std::uint32_t, 3> corners = corners_of(tetrahedra, {t, i});
      std::sort(corners.begin(), corners.end());
      all[corners].push_back({t, i});
    }
  return all;
}

std::pair<std::uint32_t, std::uint8_t> key_of(const ElementFace& face) {
  return {face.tet, face.opposite};
}

TEST(ElementFaces, OfTheSurfaceAreThoseOfOneElementInTheElementsOrder) {
  const Tetrahedra ball = halved_ball();
  std::vector<std::pair<std::uint32_t, std::uint8_t>> expected, found;
  for (const auto& [corners, faces] : by_corners(ball))
    if (faces.size() == 1) expected.push_back(key_of(faces[0]));
  std::sort(expected.begin(), expected.end());
  for (const ElementFace& face : surface_faces(ball)) found.push_back(key_of(face));
  EXPECT_GT(found.size(), 500U);
  EXPECT_EQ(found, expected);
}

TEST(ElementFaces, OfAnInterfaceAreThoseOfOneElementOfEachRegion) {
  const Tetrahedra ball = halved_ball();
  std::vector<std::array<std::uint32_t, 4>> expected, found;
  for (const auto& [corners, faces] : by_corners(ball)) {
    if (faces.size() != 2 || region_of(ball, faces[0].tet) == region_of(ball, faces[1].tet)) continue;
    const bool first = region_of(ball, faces[0].tet) == 0;
    const ElementFace& face = first ? faces[0] : faces[1];
    const ElementFace& opposite = first ? faces[1] : faces[0];
    expected.push_back({face.tet, face.opposite, opposite.tet, opposite.opposite});
  }
  std::sort(expected.begin(), expected.end());
  const std::vector<Interface> all = interfaces(ball);
  ASSERT_EQ(all.size(), 1U);
  for (std::size_t i = 0; i < all[0].faces.size(); ++i)
    found.push_back(
        {all[0].faces[i].tet, all[0].faces[i].opposite, all[0].opposite[i].tet, all[0].opposite[i].opposite});
  EXPECT_GT(found.size(), 50U);
  EXPECT_EQ(found, expected);
}

TEST(ElementFaces, OfMoreElementsThanAreLookedAtAtOnceAreAllFound) {
  const voxel::Octree ball = voxel::combine(tests::unit_universe(7), voxel::Sphere{{63.2, 63.6, 63.1}, 58.0});
  const Tetrahedra tetrahedra = tetrahedra_of(ball, BoundaryCells::Voxels);
  ASSERT_GT(4 * tetrahedra.tets.size(), std::size_t{1} << 22);
  EXPECT_EQ(surface_faces(tetrahedra).size(), 2 * voxel::cuberille_faces(ball).face_count());
}

TEST(ElementFaces, OfOneRegionHaveNoInterface) {
  const Tetrahedra cube = tetrahedra_of({voxel::Octree::full(tests::unit_universe(2))});
  EXPECT_TRUE(interfaces(cube).empty());
}

}  // namespace
}  // namespace octotomy::convert
