// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/health.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/io/read_mesh.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

using tests::told;

TEST(Health, ASolidHasNoFindings) {
  const Health h = health(mesh_of(shapes::sphere({0, 0, 0}, 1, 3)));
  EXPECT_TRUE(h.solid()) << told(h);
  EXPECT_TRUE(h.closed && h.manifold && h.oriented && h.intersections_tested);
  EXPECT_EQ(h.euler, 2);
  EXPECT_EQ(h.components, 1u);
}

TEST(Health, ACavityMustFaceInwardAndAnIslandOutward) {
  const Triangles outer = shapes::sphere({0, 0, 0}, 4, 2), cavity = shapes::sphere({0, 0, 0}, 3, 2),
                  island = shapes::sphere({0, 0, 0}, 2, 2);
  const Triangles right = shapes::together(shapes::together(outer, shapes::inside_out(cavity)), island);
  EXPECT_TRUE(health(right).solid()) << told(health(right));
  const Health wrong = health(shapes::together(shapes::together(outer, cavity), shapes::inside_out(island)));
  EXPECT_FALSE(wrong.oriented);
  EXPECT_EQ(wrong.misplaced_shells, 2u);  // the cavity adds a winding, the island takes one of two
  const Health everted = health(shapes::inside_out(outer));
  EXPECT_FALSE(everted.oriented);
  EXPECT_FALSE(everted.solid());
}

TEST(Health, NamesASurfaceThatFacesInwardAsAWhole) {
  const Triangles outer = shapes::sphere({0, 0, 0}, 4, 2), cavity = shapes::sphere({0, 0, 0}, 3, 2);
  const Triangles hollow = shapes::together(outer, shapes::inside_out(cavity));
  ASSERT_TRUE(health(hollow).solid());
  for (const Triangles& whole : {shapes::inside_out(outer), shapes::inside_out(hollow)}) {
    const Health everted = health(whole);
    EXPECT_EQ(everted.first_defect, Defect::InsideOut);
    ASSERT_EQ(everted.findings.size(), 1u) << told(everted);
    EXPECT_NE(told(everted).find("the whole surface faces inward, so that its volume is -"),
              std::string::npos)
        << told(everted);
  }
  // One shell of two, and a part beside another.
  for (const Triangles& part :
       {shapes::together(outer, cavity),
        shapes::together(outer, shapes::inside_out(shapes::sphere({9, 0, 0}, 3, 2)))}) {
    EXPECT_EQ(health(part).first_defect, Defect::MisplacedShell);
    EXPECT_EQ(told(health(part)).find("the whole surface"), std::string::npos);
  }
}

TEST(Health, CatchesAFlippedTriangle) {
  Triangles t = shapes::sphere({0, 0, 0}, 1, 2);
  std::swap(t.faces[10][0], t.faces[10][1]);
  const Health h = health(t);
  EXPECT_EQ(h.misoriented_edges, 3u);
  EXPECT_FALSE(h.oriented);
  EXPECT_TRUE(h.closed);
  EXPECT_FALSE(h.solid());
}

TEST(Health, NamesTheFirstTriangleOfEachFinding) {
  const Triangles ball = shapes::sphere({0, 0, 0}, 1, 2);
  Triangles flipped = ball, twice = ball, crossed = shapes::together(ball, shapes::sphere({1, 0, 0}, 1, 2));
  std::swap(flipped.faces[10][0], flipped.faces[10][1]);
  const std::string flip = told(health(flipped));
  // Its neighbours across three sides may be numbered lower.
  EXPECT_NE(flip.find("wind against each other (first: triangle "), flip.npos) << flip;
  twice.faces.push_back(twice.faces[7]);
  const std::string twin = told(health(twice));
  EXPECT_NE(twin.find("same points (first: triangle 7 at ("), twin.npos) << twin;
  const Health meeting = health(crossed);
  EXPECT_NE(told(meeting).find("intersect (first: triangles " + std::to_string(meeting.crossing[0].first) +
                               " and " + std::to_string(meeting.crossing[0].second) + " at ("),
            std::string::npos);
  Triangles open = ball;
  open.faces.erase(open.faces.begin());
  const Health hole = health(open);
  const auto at = hole.findings.front().find("triangle ");
  ASSERT_NE(at, std::string::npos);
  // The first triangle that has a side with the lost one's points.
  const auto sides_of_lost = [&](const std::array<std::uint32_t, 3>& face) {
    int common = 0;
    for (const std::uint32_t v : face)
      common += std::count(ball.faces[0].begin(), ball.faces[0].end(), v) > 0;
    return common == 2;
  };
  const auto first = std::find_if(open.faces.begin(), open.faces.end(), sides_of_lost) - open.faces.begin();
  EXPECT_NE(hole.findings.front().find("(first: triangle " + std::to_string(first) + " at ("),
            std::string::npos)
      << hole.findings.front();
}

TEST(Health, CatchesALostTriangle) {
  Triangles t = shapes::sphere({0, 0, 0}, 1, 2);
  t.faces.pop_back();
  const Health h = health(t);
  EXPECT_EQ(h.boundary_edges, 3u);
  EXPECT_FALSE(h.closed);
  EXPECT_EQ(h.euler, 1);
  EXPECT_FALSE(h.solid());
}

TEST(Health, CatchesADuplicatedShell) {
  const Triangles t = shapes::sphere({0, 0, 0}, 1, 1);
  const Health apart = health(shapes::together(t, t));
  EXPECT_GE(apart.self_intersections, t.faces.size());
  EXPECT_FALSE(apart.solid());
  Triangles shared = t;
  shared.faces.insert(shared.faces.end(), t.faces.begin(), t.faces.end());
  const Health together = health(shared);
  EXPECT_EQ(together.duplicate_faces, t.faces.size());
  EXPECT_EQ(together.nonmanifold_edges, 120u);
  EXPECT_FALSE(together.solid());
}

TEST(Health, CatchesShellsThatPassThroughEachOther) {
  const Triangles t = shapes::together(shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3}));
  const Health h = health(t);
  EXPECT_GT(h.self_intersections, 0u);
  EXPECT_EQ(h.crossing.size(), h.self_intersections);
  EXPECT_FALSE(h.solid());
  const Health untested = health(t, {.self_intersections = false});
  EXPECT_FALSE(untested.intersections_tested);
  EXPECT_EQ(untested.self_intersections, 0u);
}

TEST(Health, CatchesTrianglesThatFoldFlatOntoTheirNeighbours) {
  Triangles t;
  t.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {0, -1, 0}};
  t.faces = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(health(t).self_intersections, 1u);
  t.faces = {{0, 1, 2}, {1, 0, 4}};
  EXPECT_EQ(health(t).self_intersections, 0u);
}

TEST(Health, CountsTrianglesWithoutAreaExactly) {
  Triangles t;
  t.points_mm = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {3, 3, std::nextafter(3.0, 4.0)}};
  t.faces = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(health(t).degenerate_faces, 1u);
}

TEST(Health, ATouchedVertexIsNotManifold) {
  Triangles t = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 1}, {2, 2, 2}));
  for (auto& f : t.faces)
    for (auto& v : f)
      if (v == 8) v = 7;
  const Health h = health(t);
  EXPECT_EQ(h.nonmanifold_vertices, 1u);
  EXPECT_FALSE(h.manifold);
  EXPECT_EQ(h.components, 1u);
  EXPECT_EQ(h.shells, 2u);
  EXPECT_EQ(h.vertices, 16u);
  EXPECT_EQ(h.unused_vertices, 1u);
}

TEST(Health, NothingIsNoSolid) {
  EXPECT_FALSE(health(Triangles{}).solid());
}

TEST(Health, ThreadsDoNotChangeTheAnswer) {
  const Triangles t = shapes::together(shapes::sphere({0, 0, 0}, 1, 3), shapes::sphere({0.5, 0, 0}, 1, 3));
  const Health many = health(t);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Health single = health(t);
  EXPECT_GT(many.self_intersections, 0u);
  EXPECT_EQ(many.crossing, single.crossing);
  EXPECT_EQ(many.self_intersections, single.self_intersections);
}

/// Statistics measured apart from this code and kept with the data.
struct Known {
  const char* name;
  std::size_t vertices, faces, boundary_edges, nonmanifold_edges, components, self_intersections, duplicates;
};
void PrintTo(const Known& known, std::ostream* os) {
  *os << known.name;
}

class ReferenceMesh : public testing::TestWithParam<Known> {};

TEST_P(ReferenceMesh, HasTheStatisticsMeasuredElsewhere) {
  const Known& known = GetParam();
  OCTOTOMY_NEEDS_DATA(std::string("meshes/") + known.name);
  const Triangles t = read_triangles(tests::reference_data(std::string("meshes/") + known.name));
  const Health h = health(t);
  EXPECT_EQ(h.vertices, known.vertices);
  EXPECT_EQ(h.faces, known.faces);
  EXPECT_EQ(h.boundary_edges, known.boundary_edges);
  EXPECT_EQ(h.nonmanifold_edges, known.nonmanifold_edges);
  EXPECT_EQ(h.components, known.components);
  EXPECT_EQ(h.self_intersections, known.self_intersections);
  EXPECT_EQ(h.duplicate_faces, known.duplicates);
  EXPECT_EQ(h.degenerate_faces, 0u);
  const bool sound = known.boundary_edges + known.nonmanifold_edges + known.self_intersections == 0;
  EXPECT_EQ(h.solid(), sound) << told(h);
}

INSTANTIATE_TEST_SUITE_P(
    Measured, ReferenceMesh,
    testing::Values(Known{"Havocglass8_left.obj", 84, 164, 0, 0, 1, 0, 0},
                    Known{"Havocglass8_right.obj", 8, 12, 0, 0, 1, 0, 0},
                    Known{"ballA.off", 1900, 3796, 0, 0, 1, 0, 0},
                    Known{"ballB.off", 1900, 3796, 0, 0, 1, 0, 0},
                    Known{"cgal_femur.off", 3897, 7798, 0, 0, 1, 0, 0},
                    Known{"fran_cut.vtk", 2205, 4224, 184, 0, 1, 0, 0},
                    Known{"self_intersectA.obj", 8582, 17160, 0, 0, 1, 338, 0},
                    Known{"self_intersectB.obj", 8582, 17160, 0, 0, 1, 338, 0},
                    Known{"trimesh_bunny_nonmanifold.ply", 8171, 16301, 123, 150, 1, 97, 93},
                    Known{"trimesh_octagonal_pocket.stl", 1658, 3262, 54, 0, 2, 114, 0}));

}  // namespace
}  // namespace octotomy::brep
