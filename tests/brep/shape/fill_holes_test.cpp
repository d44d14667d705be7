// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/fill_holes.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace octotomy::brep
