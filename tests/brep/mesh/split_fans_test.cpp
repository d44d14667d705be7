// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/split_fans.h"

#include <gtest/gtest.h>

#include "brep/mesh/components.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/bad_meshes.h"

namespace octotomy::brep {
namespace {

using shapes::box;
using shapes::sphere;
using shapes::together;
using shapes::unwelded;
using shapes::welded;

TEST(SplitFans, SoundTrianglesStayAsTheyAre) {
  const Triangles ball = sphere({1, 2, 3}, 5, 2);
  const SplitFans split = split_fans(ball);
  EXPECT_TRUE(split.edges.empty());
  EXPECT_EQ(split.surface.faces, ball.faces);
  EXPECT_EQ(split.surface.points_mm, ball.points_mm);
}

TEST(SplitFans, CubesAlongAnEdgeBecomeTwoClosedShellsAndTheEdgeIsListed) {
  const Triangles cubes = welded(together(box({0, 0, 0}, {10, 10, 10}), box({10, 10, 0}, {20, 20, 10})));
  EXPECT_THROW(mesh_of(cubes), Error);
  const SplitFans split = split_fans(cubes);
  ASSERT_EQ(split.edges.size(), 1u);
  EXPECT_EQ(split.edges[0].triangles, 4u);
  EXPECT_EQ(split.edges[0].pairs, 2u);
  EXPECT_EQ(split.edges[0].at_mm, glm::dvec3(10, 10, 5));
  EXPECT_EQ(to_string(split.edges[0]).substr(0, 40), "edge of 4 triangles at (10, 10, 5) mm, p");
  const std::vector<Component> shells = components(mesh_of(split.surface));
  ASSERT_EQ(shells.size(), 2u);  // material between the pairs, not air
  EXPECT_NEAR(shells[0].volume_mm3, 1000.0, 1e-9);
  EXPECT_NEAR(shells[1].volume_mm3, 1000.0, 1e-9);
}

TEST(SplitFans, AFinEndsAtItsEdgeAndTheRestStaysClosed) {
  Triangles fin = sphere({0, 0, 0}, 5, 2);
  fin.points_mm.emplace_back(9, 9, 9);
  fin.faces.push_back(
      {fin.faces[0][0], fin.faces[0][1], static_cast<std::uint32_t>(fin.points_mm.size() - 1)});
  const SplitFans split = split_fans(fin);
  ASSERT_EQ(split.edges.size(), 1u);
  EXPECT_EQ(split.edges[0].pairs, 1u);
  const Health found = health(split.surface, {.self_intersections = false});
  EXPECT_EQ(found.boundary_edges, 3u);
  EXPECT_TRUE(found.manifold);
}

TEST(SplitFans, PairsThatShareBothEndsOfTheirEdgeAreCutAtItsMiddle) {
  // A bar along the edge whose ends are closed by fans about the edge's ends: two wedges that touch in the
  // edge and are joined round both of its ends, so that copies of the ends alone do not part them.
  Triangles t = welded(together(box({0, 0, 0}, {10, 10, 10}), box({10, 10, 0}, {20, 20, 10})));
  t = welded(together(together(t, box({0, 10, -10}, {10, 20, 0})), box({0, 10, 10}, {10, 20, 20})));
  const SplitFans split = split_fans(t);
  EXPECT_NO_THROW(mesh_of(split.surface));
  EXPECT_NEAR(size_of(split.surface).volume_mm3, 4000.0, 1e-9);
  EXPECT_NEAR(size_of(split.surface).area_mm2, 2400.0, 1e-9);
}

TEST(JoinedSurface, WeldsOnlyWhereThatClosesOpenEdges) {
  const Triangles ball = sphere({1, 2, 3}, 5, 2);
  const JoinedSurface closed = joined_surface(unwelded(ball));
  ASSERT_EQ(closed.findings.size(), 1u);
  EXPECT_EQ(closed.findings[0], "unwelded: 960 of 960 open edges closed by merging points that coincide");
  EXPECT_TRUE(health(closed.surface).closed);
  const Triangles touching = together(box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1}));
  EXPECT_TRUE(joined_surface(touching).findings.empty());
  EXPECT_EQ(joined_surface(touching).surface.faces, touching.faces);
}

}  // namespace
}  // namespace octotomy::brep
