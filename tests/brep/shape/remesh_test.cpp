// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/remesh.h"

#include <gtest/gtest.h>
#include <numbers>

#include "brep/measure/difference.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

struct Lengths {
  double mean_mm = 0.0;
  double share_near = 0.0;  ///< between half and three halves of the target
};

Lengths lengths_of(const Mesh& mesh, double target_mm) {
  Lengths lengths;
  const auto n = static_cast<double>(mesh.n_edges());
  for (const auto e : mesh.edges()) {
    const double length = mesh.calc_edge_length(e);
    lengths.mean_mm += length / n;
    if (length > 0.5 * target_mm && length < 1.5 * target_mm) lengths.share_near += 1.0 / n;
  }
  return lengths;
}

double smallest_angle_deg(const Mesh& mesh) {
  double smallest = 180.0;
  for (const auto h : mesh.halfedges())
    if (!mesh.is_boundary(h)) smallest = std::min(smallest, glm::degrees(mesh.calc_sector_angle(h)));
  return smallest;
}

TEST(Remesh, ABoxKeepsItsShapeToRoundingAndItsTrianglesBecomeEven) {
  const Mesh box = mesh_of(shapes::box({0, 0, 0}, {10, 14, 20}));
  const Mesh even = remesh(box, {.edge_mm = 1.5});
  EXPECT_TRUE(health(even).solid()) << health(even).findings.front();
  EXPECT_NEAR(measure(even).volume_mm3, 10 * 14 * 20, 1e-9);
  EXPECT_NEAR(measure(even).area_mm2, 2 * (140 + 200 + 280), 1e-9);
  const Lengths lengths = lengths_of(even, 1.5);
  EXPECT_NEAR(lengths.mean_mm, 1.5, 0.25);
  EXPECT_GT(lengths.share_near, 0.95);
  EXPECT_GT(smallest_angle_deg(even), 20.0);
  EXPECT_LT(lengths_of(box, 1.5).share_near, 0.1);
}

TEST(Remesh, ABallOfNeedlesBecomesEvenWithinItsSagitta) {
  // Latitudes and longitudes: needles at the poles.
  Triangles t;
  const int rows = 24, columns = 48;
  const double r = 20.0;
  t.points_mm.emplace_back(0, 0, r);
  for (int i = 1; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double a = std::numbers::pi * i / rows, b = 2 * std::numbers::pi * j / columns;
      t.points_mm.emplace_back(r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b), r * std::cos(a));
    }
  t.points_mm.emplace_back(0, 0, -r);
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns);
  };
  const auto last = static_cast<std::uint32_t>(t.points_mm.size() - 1);
  for (int j = 0; j < columns; ++j) {
    t.faces.push_back({0, at(1, j), at(1, j + 1)});
    t.faces.push_back({last, at(rows - 1, j + 1), at(rows - 1, j)});
    for (int i = 1; i + 1 < rows; ++i) {
      t.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const Mesh needles = mesh_of(t), even = remesh(needles, {.edge_mm = 2.0});
  EXPECT_TRUE(health(even).solid());
  EXPECT_LT(smallest_angle_deg(needles), 10.0);
  EXPECT_GT(smallest_angle_deg(even), 20.0);
  EXPECT_GT(lengths_of(even, 2.0).share_near, 0.95);
  // Sagitta of a 4/3 long edge, and as much again for what the given facets themselves lack.
  const double sagitta = std::pow(2.0 * 4.0 / 3.0, 2) / (8.0 * r),
               given = std::pow(r * std::numbers::pi / rows, 2) / (8.0 * r);
  EXPECT_LT(difference(even, needles, {.spacing_mm = 1.0}).hausdorff_mm, 2.0 * sagitta + given);
}

TEST(Remesh, AnOpenSheetKeepsItsBorder) {
  Triangles sheet = shapes::box({0, 0, 0}, {9, 9, 9});
  sheet.faces = {{0, 2, 3}, {0, 3, 1}};
  sheet.points_mm.resize(4);
  const Mesh even = remesh(mesh_of(sheet), {.edge_mm = 1.0});
  EXPECT_NEAR(measure(even).area_mm2, 81.0, 1e-10);
  EXPECT_GT(even.n_faces(), 100u);
}

TEST(Remesh, TheSameBitsComeEveryTime) {
  const Mesh ball = mesh_of(shapes::sphere({1, 2, 3}, 9, 3));
  const Triangles once = triangles_of(remesh(ball, {.edge_mm = 1.2})),
                  again = triangles_of(remesh(ball, {.edge_mm = 1.2}));
  EXPECT_EQ(once.points_mm, again.points_mm);
  EXPECT_EQ(once.faces, again.faces);
}

TEST(Remesh, RefusesOptionsOutOfRangeAndNamesATriangleWithoutArea) {
  const Mesh box = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(remesh(box, {.edge_mm = 0.0}), std::invalid_argument);
  EXPECT_THROW(remesh(box, {.edge_mm = 1.0, .sharp_angle_deg = 200.0}), std::invalid_argument);
  EXPECT_THROW(remesh(box, {.rounds = 0}), std::invalid_argument);
  Triangles flat = shapes::box({0, 0, 0}, {1, 1, 1});
  flat.points_mm.emplace_back(0.5, 0.5, 0.0);
  flat.faces[0] = {0, 2, 8};
  flat.faces[1] = {0, 8, 1};
  flat.faces.push_back({2, 3, 8});
  flat.faces.push_back({3, 1, 8});
  EXPECT_NO_THROW(remesh(mesh_of(flat), {.edge_mm = 0.3}));
  flat.points_mm[8] = {0.0, 0.5, 0.0};  // on the side from point 0 to point 2
  try {
    remesh(mesh_of(flat), {.edge_mm = 0.3});
    FAIL() << "a triangle without area was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("triangle 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::brep
