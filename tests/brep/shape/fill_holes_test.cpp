// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/fill_holes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

Triangles closed(const Mesh& mesh, const std::vector<Hole>& found) {
  Triangles triangles = triangles_of(mesh);
  for (const Hole& hole : found)
    triangles.faces.insert(triangles.faces.end(), hole.faces.begin(), hole.faces.end());
  return triangles;
}

TEST(FillHoles, ABoxWithoutALidGetsAFlatOne) {
  Triangles box = shapes::box({0, 0, 0}, {2, 3, 4});
  box.faces.erase(box.faces.begin() + 2, box.faces.begin() + 4);  // z = 4
  const Mesh mesh = mesh_of(box);
  const std::vector<Hole> found = holes(mesh, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].perimeter_mm, 10.0, 1e-14);
  EXPECT_LT(glm::distance(found[0].centre_mm, glm::dvec3(1, 1.5, 4)), 1e-14);
  const Triangles whole = closed(mesh, found);
  EXPECT_TRUE(health(whole).solid()) << health(whole).findings.front();
  EXPECT_NEAR(size_of(whole).volume_mm3, 24.0, 1e-13);
}

TEST(FillHoles, ABallWithACapOffLosesOnlyTheCap) {
  Triangles ball = shapes::sphere({0, 0, 0}, 5, 3);
  const double whole_mm3 = size_of(ball).volume_mm3;
  std::erase_if(ball.faces, [&](const auto& face) {
    return ball.points_mm[face[0]].z > 4.2 || ball.points_mm[face[1]].z > 4.2 ||
           ball.points_mm[face[2]].z > 4.2;
  });
  const Mesh mesh = mesh_of(ball);
  const Triangles whole = closed(mesh, holes(mesh, {}));
  EXPECT_TRUE(health(whole).solid());
  EXPECT_LT(size_of(whole).volume_mm3, whole_mm3);
  EXPECT_GT(size_of(whole).volume_mm3, 0.95 * whole_mm3);
}

TEST(FillHoles, OneLongerThanAllowedStaysOpen) {
  Triangles ball = shapes::sphere({0, 0, 0}, 5, 2);
  ball.faces.pop_back();
  ball.faces.erase(ball.faces.begin() + 5, ball.faces.begin() + 9);
  const Mesh mesh = mesh_of(ball);
  const std::vector<Hole> all = holes(mesh, {});
  ASSERT_GE(all.size(), 2u);
  double least = 1e9, most = 0.0;
  for (const Hole& hole : all) {
    least = std::min(least, hole.perimeter_mm);
    most = std::max(most, hole.perimeter_mm);
  }
  ASSERT_LT(least, most);
  for (const Hole& hole : holes(mesh, 0.5 * (least + most)))
    EXPECT_EQ(hole.faces.empty(), hole.perimeter_mm > 0.5 * (least + most));
}

glm::dvec3 on_circle(std::uint32_t k, std::uint32_t sides, double radius, double z) {
  const double angle = 2 * std::numbers::pi * k / sides;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// A cup on a round floor at z = 0, a fan; `rim(side)` says where its open rim runs.
template <typename Rim>
Triangles cup(std::uint32_t sides, const Rim& rim) {
  Triangles t;
  for (std::uint32_t k = 0; k < sides; ++k) t.points_mm.push_back(on_circle(k, sides, 10.0, 0.0));
  for (std::uint32_t k = 0; k < sides; ++k) t.points_mm.push_back(rim(k));
  t.points_mm.emplace_back(0, 0, 0);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t next = (k + 1) % sides;
    t.faces.insert(t.faces.end(),
                   {{k, next, sides + next}, {k, sides + next, sides + k}, {next, k, 2 * sides}});
  }
  return t;
}

TEST(FillHoles, ABorderOfThousandsOfSidesIsClosedFlat) {
  constexpr std::uint32_t sides = 3000;
  const Mesh mesh = mesh_of(cup(sides, [](std::uint32_t k) { return on_circle(k, sides, 10.0, 10.0); }));
  const std::vector<Hole> found = holes(mesh, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].faces.size(), sides - 2);
  const Triangles whole = closed(mesh, found);
  EXPECT_TRUE(health(whole).solid()) << health(whole).findings.front();
  EXPECT_NEAR(size_of(whole).volume_mm3, 500 * sides * std::sin(2 * std::numbers::pi / sides), 1e-8);
}

TEST(FillHoles, CornersCutOffALongBorderStayInside) {
  constexpr std::uint32_t sides = 1500;
  // Every corner that points inward would be cut off outside of the rim.
  const Mesh mesh = mesh_of(
      cup(sides, [](std::uint32_t k) { return on_circle(k, sides, k % 2 == 0 ? 10.0 : 9.97, 10.0); }));
  const Triangles whole = closed(mesh, holes(mesh, {}));
  EXPECT_TRUE(health(whole).solid()) << health(whole).findings.front();
}

TEST(FillHoles, ASheetWhoseCornersHaveTheirThirdSideIsClosedAlongALongBorder) {
  // At two corners of a grid the side that would cut them off is one of the grid's.
  constexpr std::uint32_t n = 50;
  Triangles sheet;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) sheet.points_mm.emplace_back(i, j, 0);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t at = i * (n + 1) + j, across = at + n + 1;
      sheet.faces.insert(sheet.faces.end(), {{at, across, across + 1}, {at, across + 1, at + 1}});
    }
  const Mesh mesh = mesh_of(sheet);
  const std::vector<Hole> found = holes(mesh, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].border.size(), 4 * n);
  EXPECT_EQ(found[0].faces.size(), 4 * n - 2);
  const Health whole = health(closed(mesh, found), {.self_intersections = false});
  EXPECT_TRUE(whole.closed && whole.manifold && whole.misoriented_edges == 0);
}

TEST(FillHoles, ALongBorderWithoutCornersToCutOffStaysOpen) {
  constexpr std::uint32_t sides = 1100;
  // The rim runs along a line but for one point, the corner that is cut off first.
  const Mesh mesh =
      mesh_of(cup(sides, [](std::uint32_t k) { return glm::dvec3(k, k == 500 ? 5.0 : 0.0, 10.0); }));
  const std::vector<Hole> found = holes(mesh, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].border.size(), sides);
  EXPECT_TRUE(found[0].faces.empty());
}

}  // namespace
}  // namespace octotomy::brep
