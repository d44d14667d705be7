// SPDX-License-Identifier: AGPL-3.0-or-later
// The same question to VTK's filters.
#include "tests/brep/mesh/vtk_distance.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/io/read_mesh.h"
#include "brep/measure/difference.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "brep/mesh/oriented_surface.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

tests::FlatSurface flat(const Mesh& mesh) {
  const Triangles triangles = triangles_of(mesh);
  tests::FlatSurface surface;
  for (const glm::dvec3& p : triangles.points_mm) surface.points.push_back({p.x, p.y, p.z});
  for (const auto& f : triangles.faces) surface.faces.push_back({f[0], f[1], f[2]});
  return surface;
}

double extent_mm(const Mesh& mesh) {
  const Measures measures = measure(mesh);
  return glm::distance(measures.low_mm, measures.high_mm);
}

Mesh scan_of_a_face() {
  Triangles face = read_triangles(tests::reference_data("meshes/fran_cut.vtk"));
  for (glm::dvec3& p : face.points_mm) p *= 1000.0;
  return mesh_of(face);
}

TEST(VtkDistance, SignedDistancesOfPointsAboutABodyAgree) {
  Triangles body = shapes::sphere({0, 0, 0}, 10, 3);
  for (glm::dvec3& p : body.points_mm) p *= 1.0 + 0.3 * std::sin(p.x) * std::cos(0.5 * p.y);
  const Mesh mesh = mesh_of(body);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-15.0, 15.0);
  std::vector<glm::dvec3> points(2000);
  std::vector<tests::Point> asked;
  for (glm::dvec3& p : points) {
    p = {uniform(random), uniform(random), uniform(random)};
    asked.push_back({p.x, p.y, p.z});
  }
  const auto feet = OrientedSurface(mesh).feet(points);
  const auto of_vtk = tests::vtk_signed_distances(flat(mesh), asked);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(feet[i].distance_mm, of_vtk[i], 1e-6 * extent_mm(mesh)) << "point " << i;
    inside += feet[i].distance_mm < 0.0;
  }
  EXPECT_GT(inside, 200u);
}

TEST(VtkDistance, TheDistanceFilterAgreesOnAFaceThatMoved) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  const Mesh still = scan_of_a_face();
  glm::dmat4 motion = glm::translate(glm::dmat4(1.0), glm::dvec3(1.0, -2.0, 0.5));
  motion = glm::rotate(motion, 0.03, glm::normalize(glm::dvec3(1, 2, 3)));
  const Mesh there = moved(still, motion);
  const Difference ours = difference(there, still, {.spacing_mm = 5.0});
  const auto of_vtk = tests::vtk_vertex_distances(flat(there), flat(still));
  ASSERT_EQ(ours.vertex_mm.size(), of_vtk.size());
  double largest = 0.0;
  std::size_t same_sign = 0;
  for (std::size_t v = 0; v < of_vtk.size(); ++v) {
    EXPECT_NEAR(std::abs(ours.vertex_mm[v]), std::abs(of_vtk[v]), 1e-6 * extent_mm(still)) << "vertex " << v;
    // Beyond the border of an open surface the sign is a guess, ours and theirs.
    same_sign += (ours.vertex_mm[v] < 0.0) == (of_vtk[v] < 0.0);
    largest = std::max(largest, std::abs(of_vtk[v]));
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_GT(same_sign, of_vtk.size() * 19 / 20);
}

}  // namespace
}  // namespace octotomy::brep
