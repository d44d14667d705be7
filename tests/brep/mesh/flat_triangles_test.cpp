// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/flat_triangles.h"

#include <gtest/gtest.h>

#include "brep/boolean/boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

/// A cube of edge 2 whose edge from point 0 to 1 carries `points` more, all in triangles without area on the
/// side y = 0: a fan of slivers about point 0, and the side z = 0 joined to their long side.
Triangles cube_with_flat_triangles(int points) {
  Triangles t = shapes::box({0, 0, 0}, {2, 2, 2});
  // {0, 1, 5} is the only triangle of y = 0 along that edge: it is fanned out from point 5.
  std::erase(t.faces, std::array<std::uint32_t, 3>{0, 1, 5});
  std::uint32_t before = 0;
  for (int k = 1; k <= points; ++k) {
    const auto added = static_cast<std::uint32_t>(t.points_mm.size());
    t.points_mm.emplace_back(2.0 * k / (points + 1), 0.0, 0.0);
    t.faces.push_back({before, added, 5});
    if (k > 1) t.faces.push_back({0, added, before});
    before = added;
  }
  t.faces.push_back({before, 1, 5});
  t.faces.push_back({0, 1, before});
  return t;
}

/// Flat triangles keep health() from proving it.
Solid trusted(const Triangles& t) {
  return trusted_solid(t, Proof::Connection);
}

TEST(FlatTriangles, AnotherDiagonalTakesThemOutAndMovesNothing) {
  for (const int points : {1, 2, 3, 7}) {
    Mesh mesh = mesh_of(cube_with_flat_triangles(points));
    const Health before = health(mesh);
    ASSERT_EQ(before.degenerate_faces, static_cast<std::size_t>(points));
    ASSERT_TRUE(has_flat_triangles(triangles_of(mesh)));
    const FlatTriangles done = take_out_flat_triangles(mesh);
    EXPECT_GE(done.flips, static_cast<std::size_t>(points));
    EXPECT_EQ(done.left, 0u) << points;
    EXPECT_FALSE(has_flat_triangles(triangles_of(mesh)));
    const Health after = health(mesh);
    EXPECT_TRUE(after.solid()) << points << ": " << after.findings.front();
    EXPECT_EQ(after.vertices, before.vertices);
    EXPECT_NEAR(volume_mm3(mesh), 8.0, 1e-14);
    EXPECT_NEAR(measure(mesh).area_mm2, 24.0, 1e-14);
  }
}

TEST(FlatTriangles, PointsAtOnePlaceBecomeOne) {
  // A ball's vertex split in two at its place.
  Triangles ball = shapes::sphere({0, 0, 0}, 3, 1);
  Mesh mesh = mesh_of(ball);
  const auto v = Mesh::VertexHandle(0);
  auto ring = mesh.cvv_begin(v);
  const Mesh::VertexHandle one = *ring++;
  ++ring;
  const Mesh::VertexHandle other = *ring;
  const Mesh::Point place = mesh.point(v);
  mesh.vertex_split(mesh.add_vertex(place), v, one, other);
  const Health before = health(mesh);
  ASSERT_EQ(before.degenerate_faces, 2u);
  const FlatTriangles done = take_out_flat_triangles(mesh);
  EXPECT_EQ(done.collapses, 1u);
  EXPECT_EQ(done.left, 0u);
  EXPECT_TRUE(health(mesh).solid());
  EXPECT_EQ(mesh.n_vertices(), ball.points_mm.size());
}

TEST(FlatTriangles, OneAtABorderIsLeftAndCounted) {
  Triangles strip;
  strip.points_mm = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  strip.faces = {{0, 1, 2}, {2, 1, 3}, {0, 2, 3}};
  Mesh mesh = mesh_of(strip);
  const FlatTriangles done = take_out_flat_triangles(mesh);
  EXPECT_EQ(done.flips, 0u);
  EXPECT_EQ(done.left, 1u);
}

TEST(FlatTriangles, ABooleanSaysHowAndNothingWhereThereAreNone) {
  const Solid knife = solid_of(shapes::box({0.3, -1, -1}, {1.7, 1, 1}));
  for (const int points : {0, 1, 2}) {
    const Solid cube =
        trusted(points == 0 ? shapes::box({0, 0, 0}, {2, 2, 2}) : cube_with_flat_triangles(points));
    std::string told;
    for (const std::string& finding : boolean(cube, Operation::Difference, knife).findings) told += finding;
    EXPECT_EQ(told.empty(), points == 0) << told;
    if (points == 1) {
      EXPECT_NE(told.find("by 1 other diagonal;"), std::string::npos) << told;
    }
    if (points == 2) {
      EXPECT_NE(told.find("other diagonals;"), std::string::npos) << told;
    }
  }
}

TEST(FlatTriangles, ABooleanTakesAnOperandThatHasThemAndSaysSo) {
  const Solid cube = trusted(cube_with_flat_triangles(3));
  const BooleanResult cut =
      boolean(cube, Operation::Difference, solid_of(shapes::box({0.3, -1, -1}, {1.7, 1, 1})));
  EXPECT_NEAR(volume_mm3(cut.solid), 8.0 - 1.4, 1e-12);
  EXPECT_TRUE(health(cut.solid).solid());
  bool told = false, shifted = false;
  for (const std::string& finding : cut.findings) {
    told |= finding.find("without area") != finding.npos;
    shifted |= finding.rfind("shifted", 0) == 0;
  }
  EXPECT_TRUE(told);
  EXPECT_FALSE(shifted);
}

}  // namespace
}  // namespace octotomy::brep
