// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/coordinate_order.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

Triangles shuffled(const Triangles& triangles, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint32_t> place(triangles.points_mm.size());
  std::iota(place.begin(), place.end(), 0u);
  std::shuffle(place.begin(), place.end(), random);
  Triangles other = triangles;
  for (std::size_t v = 0; v < place.size(); ++v) other.points_mm[place[v]] = triangles.points_mm[v];
  for (auto& face : other.faces) {
    for (std::uint32_t& v : face) v = place[v];
    std::rotate(face.begin(), face.begin() + static_cast<long>(random() % 3), face.end());
  }
  std::shuffle(other.faces.begin(), other.faces.end(), random);
  return other;
}

/// Two tetrahedra whose tips stand at one place and are two vertices.
Triangles tip_to_tip() {
  return shapes::together(
      Triangles{{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}},
      Triangles{{{0, 0, 0}, {-1, 0, -1}, {0, -1, -1}, {0, 0, -1}},
                {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}});
}

TEST(CoordinateOrder, TheSameSurfaceInAnyOrderComesOutTheSame) {
  const Triangles ball = shapes::sphere({1, 2, 3}, 5, 2);
  const Triangles wanted = in_coordinate_order(mesh_of(ball));
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Triangles got = in_coordinate_order(mesh_of(shuffled(ball, seed)));
    EXPECT_EQ(got.points_mm, wanted.points_mm) << "seed " << seed;
    EXPECT_EQ(got.faces, wanted.faces) << "seed " << seed;
  }
  EXPECT_NEAR(size_of(wanted).volume_mm3, size_of(ball).volume_mm3, 1e-12);
}

TEST(CoordinateOrder, PointsAtOnePlaceGoByTheirNeighbours) {
  const Triangles tip = tip_to_tip();
  const Triangles wanted = in_coordinate_order(mesh_of(tip));
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    EXPECT_EQ(in_coordinate_order(mesh_of(shuffled(tip, seed))).faces, wanted.faces) << "seed " << seed;
}

TEST(CoordinateOrder, AMeshWhoseWalkAboutATipNeverEndsIsOrderedToo) {
  Mesh mesh = mesh_of(tip_to_tip());
  const auto wanted = in_coordinate_order(mesh).faces;
  // Of the three halfedges out of the tip, in the walk's order, the last leads to the second again.
  const auto first = mesh.halfedge_handle(Mesh::VertexHandle(0));
  const auto second = mesh.cw_rotated_halfedge_handle(first), third = mesh.cw_rotated_halfedge_handle(second);
  mesh.set_halfedge_handle(mesh.face_handle(first), first);  // so that the face's corners stay
  mesh.set_next_halfedge_handle(mesh.opposite_halfedge_handle(third), second);
  EXPECT_EQ(in_coordinate_order(mesh).faces, wanted);
}

}  // namespace
}  // namespace octotomy::brep
