// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/triangles.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

std::string refusal_of(const Triangles& triangles) {
  try {
    mesh_of(triangles);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "";
}

TEST(Triangles, ComeBackFromTheMeshInTheirOwnOrder) {
  Triangles sphere = shapes::sphere({1, 2, 3}, 4, 2);
  std::swap(sphere.faces[0], sphere.faces[100]);
  const Mesh mesh = mesh_of(sphere);
  EXPECT_EQ(mesh.n_faces(), 320u);
  EXPECT_EQ(mesh.n_edges(), 480u);
  EXPECT_EQ(mesh.n_vertices(), 162u);
  const Triangles back = triangles_of(mesh);
  EXPECT_EQ(back.points_mm, sphere.points_mm);
  EXPECT_EQ(back.faces, sphere.faces);
}

TEST(Triangles, EveryLoopOfHalfedgesClosesInTheInsideAndAlongTheBoundary) {
  Triangles open = shapes::sphere({0, 0, 0}, 1, 2);
  open.faces.erase(open.faces.begin() + 7);
  open.faces.erase(open.faces.begin() + 200);
  const Mesh mesh = mesh_of(open);
  int boundary_count = 0;
  for (const auto h : mesh.halfedges()) {
    int steps = 0;
    auto walker = Mesh::HalfedgeHandle(h);
    do {
      EXPECT_EQ(mesh.prev_halfedge_handle(mesh.next_halfedge_handle(walker)), walker);
      EXPECT_EQ(mesh.to_vertex_handle(walker), mesh.from_vertex_handle(mesh.next_halfedge_handle(walker)));
      EXPECT_EQ(mesh.face_handle(walker), mesh.face_handle(h));
      walker = mesh.next_halfedge_handle(walker);
    } while (++steps < 10 && walker != h);
    EXPECT_EQ(steps, 3) << "halfedge " << h.idx();
    boundary_count += mesh.is_boundary(h);
  }
  EXPECT_EQ(boundary_count, 6);
  for (const auto v : mesh.vertices()) {
    EXPECT_EQ(mesh.from_vertex_handle(mesh.halfedge_handle(v)), v);
    bool touches = false;
    for (const auto h : mesh.voh_range(v)) touches |= mesh.is_boundary(h);
    EXPECT_EQ(mesh.is_boundary(v), touches);
  }
}

TEST(Triangles, FansThatOnlyTouchGetAVertexEachSoThatBothSurfacesStayClosed) {
  // Two tetrahedra with one point in common.
  Triangles t;
  t.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  t.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  const Mesh mesh = mesh_of(t);
  EXPECT_EQ(mesh.n_vertices(), 8u);
  EXPECT_EQ(mesh.point(Mesh::VertexHandle(7)), Mesh::Point(0, 0, 0));
  EXPECT_EQ(mesh.n_edges(), 12u);
  for (const auto e : mesh.edges()) EXPECT_FALSE(mesh.is_boundary(e));
}

TEST(Triangles, OfManyTheFewFansThatTouchAreFoundOnAnyNumberOfThreads) {
  // Tetrahedra, each of which has points of its own, but for one that stands on the point of another.
  for (const std::uint32_t touching : {0u, 1u, 700u, 1999u})
    for (const int threads : {1, 2, 5}) {
      Triangles triangles;
      for (std::uint32_t i = 0; i < 2000; ++i) {
        const std::uint32_t p = 4 * i;
        for (const glm::dvec3& corner : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
          triangles.points_mm.push_back(corner + glm::dvec3(2.0 * i, 0, 0));
        const std::uint32_t first = i > 0 && i == touching ? 3 : p;
        triangles.faces.insert(
            triangles.faces.end(),
            {{first, p + 2, p + 1}, {first, p + 1, p + 3}, {first, p + 3, p + 2}, {p + 1, p + 2, p + 3}});
      }
      tbb::task_arena arena(threads);
      const Linked made = arena.execute([&] { return linked(triangles); });
      EXPECT_TRUE(made.is_closed());
      ASSERT_EQ(made.triangles.points_mm.size(), touching > 0 ? 8001U : 8000U) << touching;
      if (touching > 0) {
        EXPECT_EQ(made.triangles.points_mm.back(), triangles.points_mm[3]);
        for (const std::size_t face : {0, 1, 2})
          EXPECT_EQ(made.triangles.faces[4 * touching + face][0], 8000U);
        triangles.faces = made.triangles.faces;
        for (auto& face : triangles.faces)
          for (std::uint32_t& point : face) point = point == 8000 ? 4 * touching : point;
      }
      for (std::uint32_t i = 0; i < 2000; ++i) EXPECT_EQ(triangles.faces[4 * i][0], 4 * i);
    }
}

TEST(Triangles, KeepPointsThatNoneOfThemUses) {
  Triangles t = shapes::box({0, 0, 0}, {1, 1, 1});
  t.points_mm.emplace_back(9, 9, 9);
  EXPECT_EQ(triangles_of(mesh_of(t)).points_mm, t.points_mm);
}

TEST(Triangles, LinkedOnesAreTheMeshsOwnAndKnowWhatLiesBeyondEachSide) {
  // Two tetrahedra with one point in common, one of them open.
  Triangles t;
  t.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  t.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {4, 6, 5}};
  const Linked found = linked(t);
  const Triangles expected = triangles_of(mesh_of(t));
  EXPECT_EQ(found.triangles.points_mm, expected.points_mm);
  EXPECT_EQ(found.triangles.faces, expected.faces);
  std::size_t open = 0;
  for (std::uint32_t c = 0; c < found.opposite.size(); ++c) {
    const std::uint32_t beyond = found.opposite[c];
    if (beyond == Linked::none) {
      ++open;
      continue;
    }
    EXPECT_EQ(found.opposite[beyond], c);
    EXPECT_EQ(found.triangles.faces[c / 3][c % 3], found.triangles.faces[beyond / 3][(beyond + 1) % 3]);
  }
  EXPECT_EQ(open, 3u);
}

TEST(Triangles, OfAMeshAreLinkedAsTheyAreOfAList) {
  Triangles t = shapes::together(shapes::sphere({10, -20, 30}, 5, 3), shapes::box({-1, 2, -3}, {2, 4, 1}));
  t.faces.erase(t.faces.begin() + 7);
  const Linked of_list = linked(t), of_mesh = linked_of(mesh_of(t));
  EXPECT_EQ(of_mesh.triangles.points_mm, of_list.triangles.points_mm);
  EXPECT_EQ(of_mesh.triangles.faces, of_list.triangles.faces);
  EXPECT_EQ(of_mesh.opposite, of_list.opposite);
  EXPECT_FALSE(of_mesh.is_closed());
  EXPECT_TRUE(linked(shapes::box({-1, 2, -3}, {2, 4, 1})).is_closed());
}

TEST(Triangles, TheFirstOneThatCannotBeJoinedIsNamed) {
  Triangles t = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(refusal_of(t), "");

  Triangles flipped = t;
  std::swap(flipped.faces[5][0], flipped.faces[5][1]);
  EXPECT_NE(refusal_of(flipped).find("triangle 5 runs along an edge the same way"), std::string::npos)
      << refusal_of(flipped);

  Triangles finned = t;
  finned.points_mm.emplace_back(5, 5, 5);
  finned.faces.push_back({0, 1, 8});
  EXPECT_NE(refusal_of(finned).find("triangle 12"), std::string::npos) << refusal_of(finned);

  Triangles dangling = t;
  dangling.faces[3][2] = 8;
  EXPECT_NE(refusal_of(dangling).find("triangle 3 refers to point 8 of 8"), std::string::npos);

  Triangles repeating = t;
  repeating.faces[4] = {1, 1, 5};
  EXPECT_NE(refusal_of(repeating).find("triangle 4 repeats a point"), std::string::npos);

  Triangles infinite = t;
  infinite.points_mm[7].y = INFINITY;
  EXPECT_NE(refusal_of(infinite).find("triangle 2 has a point that is not finite"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::brep
