// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/isosurface_stuffing.h"

#include <gtest/gtest.h>
#include <map>
#include <random>

#include "brep/mesh/distance.h"
#include "brep/mesh/measure.h"
#include "convert/tet/element_faces.h"
#include "convert/tet/tetrahedralise.h"
#include "tests/convert/surfaces.h"

namespace octotomy::convert {
namespace {

using tests::ball;
using tests::box;
using tests::inside_out;
using tests::together;

/// How many elements have each face; a conforming mesh has one or two.
std::size_t most_at_a_face(const Tetrahedra& t) {
  std::map<std::array<std::uint32_t, 3>, std::size_t> count;
  for (const auto& tet : t.tets)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<std::uint32_t, 3> face{tet[(left_out + 1) % 4], tet[(left_out + 2) % 4],
                                        tet[(left_out + 3) % 4]};
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  std::size_t most = 0;
  for (const auto& [face, elements] : count) most = std::max(most, elements);
  return most;
}

void expect_sound(const Tetrahedra& t) {
  const TetQuality q = quality(t);
  EXPECT_GT(q.min_volume_mm3, 0.0);
  EXPECT_GT(q.min_dihedral_deg, stuffed_dihedral_deg());
  EXPECT_LE(most_at_a_face(t), 2u);
  // The boundary's volume equals that of the elements: no two overlap, and none is missing between others.
  EXPECT_NEAR(tests::volume_mm3(surface_of(t)), q.volume_mm3, 1e-9 * q.volume_mm3);
}

/// Tetrahedra of random corners that cross each other in every way.
brep::Triangles heap(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(0.0, 10.0);
  brep::Triangles soup;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(soup.points_mm.size());
    for (int k = 0; k < 4; ++k) soup.points_mm.emplace_back(at(random), at(random), at(random));
    for (const std::array<std::uint32_t, 3>& f :
         {std::array<std::uint32_t, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
      soup.faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
  return soup;
}

TEST(IsosurfaceStuffing, ABallsVolumeAndSurfaceConvergeAsTheSquareOfTheCell) {
  const brep::Triangles surface = ball({3, -50, 20}, 10.0, 5);
  const double truth_mm3 = tests::volume_mm3(surface);
  double before = 0.0;
  for (const double cell_mm : {2.0, 1.0}) {
    const Tetrahedra t = stuff(surface, {cell_mm, {}});
    expect_sound(t);
    const double missing = truth_mm3 - quality(t).volume_mm3;
    EXPECT_GT(missing, 0.0) << "chords lie inside";
    if (before > 0.0) {
      EXPECT_NEAR(before / missing, 4.0, 0.8);
    }
    before = missing;
    std::vector<glm::dvec3> nodes_mm;
    for (const std::uint32_t v : t.boundary_nodes) nodes_mm.push_back(t.nodes_mm[v]);
    for (const double apart_mm : brep::SurfaceTree(surface).distances_mm(nodes_mm)) ASSERT_LT(apart_mm, 1e-6);
  }
}

TEST(IsosurfaceStuffing, NoHeapOfCrossingTrianglesMakesAnElementFlat) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Tetrahedra t = stuff(heap(seed, 12), {0.4, {}});
    ASSERT_GT(t.tets.size(), 5000u);
    expect_sound(t);
  }
}

TEST(IsosurfaceStuffing, AMeshThatKeepsItsLatticeWhereTheSurfaceIsNearIsFlat) {
  // The twin of the test above: the same check sees one node that is moved onto the others' plane.
  Tetrahedra t = stuff(ball({0, 0, 0}, 5.0, 3), {1.0, {}});
  const auto& tet = t.tets[t.tets.size() / 2];
  t.nodes_mm[tet[0]] = (t.nodes_mm[tet[1]] + t.nodes_mm[tet[2]] + t.nodes_mm[tet[3]]) / 3.0 +
                       0.01 * (t.nodes_mm[tet[0]] - t.nodes_mm[tet[1]]);
  EXPECT_LT(quality(t).min_dihedral_deg, stuffed_dihedral_deg());
}

TEST(IsosurfaceStuffing, ACavityStaysEmptyAndAnIslandInItIsFilled) {
  const brep::Triangles parts = together(
      together(ball({0, 0, 0}, 20.0, 4), inside_out(ball({2, 0, 0}, 12.0, 4))), ball({2, 0, 0}, 5.0, 4));
  const Tetrahedra t = stuff(parts, {1.0, {}});
  expect_sound(t);
  EXPECT_NEAR(quality(t).volume_mm3 / tests::volume_mm3(parts), 1.0, 0.01);
}

TEST(IsosurfaceStuffing, FlatSidesOnTheLatticesOwnPlanesAreMet) {
  const Tetrahedra t = stuff(box({0, 0, 0}, {8, 8, 8}), {1.0, {}});
  expect_sound(t);
  EXPECT_NEAR(quality(t).volume_mm3, 512.0, 12 * 8.0 * 0.5) << "twelve edges, each cut off within a cell";
}

TEST(IsosurfaceStuffing, WhatIsThinnerThanACellGivesNothingOrLittleAndNeverFails) {
  EXPECT_LT(stuff(box({0, 0, 0}, {8, 8, 1e-4}), {1.0, {}}).tets.size(), 2000u);
  EXPECT_THROW(stuff(box({0, 0, 0}, {8, 8, 8}), {0.0, {}}), std::invalid_argument);
  EXPECT_THROW(stuff(box({0, 0, 0}, {8, 8, 8}), {1e-4, {}}), voxel::Error);
  EXPECT_THROW(stuff({}, {}), std::invalid_argument);
}

TEST(IsosurfaceStuffing, TheCellOfANumberOfElementsGivesAboutThatNumber) {
  const brep::Triangles surface = ball({0, 0, 0}, 10.0, 4);
  const double cell_mm = cell_of_elements_mm(tests::volume_mm3(surface), 20000.0);
  EXPECT_NEAR(static_cast<double>(stuff(surface, {cell_mm, {}}).tets.size()), 20000.0, 3000.0);
}

}  // namespace
}  // namespace octotomy::convert
