// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/weld_seams.h"

#include <gtest/gtest.h>
#include <string>

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/bad_meshes.h"
#include "tests/brep/shapes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::brep {
namespace {

/// A cube of 8 mm3 whose sides have points of their own, as a program leaves it that stores normals.
Triangles split_cube() {
  const Triangles cube = shapes::box({0, 0, 0}, {2, 2, 2});
  Triangles split;
  for (const glm::dvec3& normal :
       {glm::dvec3(-1, 0, 0), {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
    std::vector<std::uint32_t> number(cube.points_mm.size(), ~0u);
    for (const auto& face : cube.faces) {
      const glm::dvec3 &a = cube.points_mm[face[0]], &b = cube.points_mm[face[1]],
                       &c = cube.points_mm[face[2]];
      if (glm::dot(glm::normalize(glm::cross(b - a, c - a)), normal) < 0.5) continue;
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        if (number[face[k]] == ~0u) {
          number[face[k]] = static_cast<std::uint32_t>(split.points_mm.size());
          split.points_mm.push_back(cube.points_mm[face[k]]);
        }
        corners[k] = number[face[k]];
      }
      split.faces.push_back(corners);
    }
  }
  return split;
}

TEST(WeldSeams, ClosesACubeThatNormalsSplit) {
  Triangles split = split_cube();
  ASSERT_EQ(split.points_mm.size(), 24u);
  ASSERT_FALSE(health(split).closed);
  const auto findings = weld_seams(split);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "points");
  EXPECT_EQ(findings[0].verdict, MeshVerdict::Pass);
  EXPECT_NE(findings[0].detail.find("16 points"), std::string::npos) << findings[0].detail;
  EXPECT_NE(findings[0].detail.find("24 open sides"), std::string::npos) << findings[0].detail;
  EXPECT_EQ(split.points_mm.size(), 8u);
  EXPECT_TRUE(health(split).solid());
  EXPECT_DOUBLE_EQ(size_of(split).volume_mm3, 8.0);
}

TEST(WeldSeams, LeavesWhatIsSoundAsItIs) {
  // Solids that share a corner, an edge and a whole side, none of which has an open side.
  for (const glm::dvec3& low : {glm::dvec3(2, 2, 2), {2, 2, 0}, {2, 0, 0}}) {
    Triangles two = shapes::together(shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box(low, low + 2.0));
    const Triangles before = two;
    EXPECT_TRUE(weld_seams(two).empty());
    EXPECT_EQ(two.faces, before.faces);
    EXPECT_EQ(two.points_mm, before.points_mm);
    EXPECT_EQ(health(two, {false}).nonmanifold_edges, 0u);
  }
}

TEST(WeldSeams, SplitSolidsThatTouchStayTwo) {
  for (const glm::dvec3& low : {glm::dvec3(2, 2, 2), {2, 2, 0}, {5, 5, 5}}) {
    Triangles other = split_cube();
    for (glm::dvec3& p : other.points_mm) p += low;
    Triangles two = shapes::together(split_cube(), other);
    EXPECT_FALSE(weld_seams(two).empty());
    EXPECT_EQ(two.points_mm.size(), 16u) << "corners that they share are two points";
    const Health found = health(two, {false});
    EXPECT_TRUE(found.closed && found.manifold);
  }
  // Four open sides coincide along a common side, so it is unknown which belong together.
  Triangles other = split_cube();
  for (glm::dvec3& p : other.points_mm) p.x += 2.0;
  Triangles two = shapes::together(split_cube(), other);
  weld_seams(two);
  const Health found = health(two, {false});
  EXPECT_EQ(found.nonmanifold_edges, 0u);
  EXPECT_EQ(found.boundary_edges, 16u);
}

TEST(WeldSeams, OpenSidesThatRunTheSameWayStayOpen) {
  // Two coincident sheets that face the same way, and a hole.
  Triangles sheets = shapes::together({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}},
                                      {{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}}});
  EXPECT_TRUE(weld_seams(sheets).empty());
  EXPECT_EQ(health(sheets).boundary_edges, 6u);
  Triangles holed = shapes::without(shapes::box({0, 0, 0}, {2, 2, 2}), {0});
  EXPECT_TRUE(weld_seams(holed).empty());
  EXPECT_EQ(health(holed).boundary_edges, 3u);
}

TEST(WeldSeams, LeavesOutTrianglesThatRepeatACorner) {
  Triangles cube = shapes::box({0, 0, 0}, {2, 2, 2});
  cube.faces.push_back({0, 0, 1});
  const auto findings = weld_seams(cube);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].detail.substr(0, 30), "1 triangle that repeats a corn");
  EXPECT_TRUE(health(cube).solid());
  // With points of its own.
  Triangles soup = shapes::unwelded(shapes::box({0, 0, 0}, {2, 2, 2}));
  soup.points_mm.insert(soup.points_mm.end(), {{0, 0, 0}, {0, 0, 0}, {2, 0, 0}});
  soup.faces.push_back({36, 37, 38});
  EXPECT_EQ(weld_seams(soup).size(), 2u);
  EXPECT_TRUE(health(soup).solid());
  EXPECT_EQ(soup.faces.size(), 12u);
  // A triangle without area that has three points is part of the surface.
  Triangles flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_TRUE(drop_repeating(flat).empty());
  EXPECT_EQ(flat.faces.size(), 1u);
}

TEST(WeldSeams, HoldsForFilesOfFormatsThatRepeatPoints) {
  const tests::ScratchFolder folder;
  for (const char* name : {"a.obj", "a.ply", "a.vtp", "a.stl"}) {
    write_mesh(split_cube(), folder / name);
    EXPECT_TRUE(health(read_triangles(folder / name)).solid()) << name;
  }
  write_mesh(split_cube(), folder / "a.off");
  EXPECT_EQ(read_triangles(folder / "a.off").points_mm.size(), 24u);
}

}  // namespace
}  // namespace octotomy::brep
