// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/difference.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <tbb/global_control.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/error.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

Mesh box_mesh(const glm::dvec3& low, const glm::dvec3& high) {
  return mesh_of(shapes::box(low, high));
}

/// Each vertex moved along the normal of its triangles.
Mesh moved_along_normals(Mesh mesh, double by_mm) {
  mesh.request_face_normals();
  mesh.request_vertex_normals();
  mesh.update_normals();
  for (const auto v : mesh.vertices()) mesh.set_point(v, mesh.point(v) + by_mm * mesh.normal(v));
  mesh.release_vertex_normals();
  mesh.release_face_normals();
  return mesh;
}

TEST(Difference, ASurfaceAndItselfDoNotDiffer) {
  const Mesh mesh = mesh_of(shapes::sphere({1, 2, 3}, 10, 3));
  const Difference d = difference(mesh, mesh);
  EXPECT_LT(d.hausdorff_mm, 1e-14);
  EXPECT_LT(d.mean_mm, 1e-14);
  EXPECT_GT(d.sample_count, 100'000u);
}

TEST(Difference, APointThatNoTriangleUsesIsNotOnTheSurface) {
  Triangles ball = shapes::sphere({1, 2, 3}, 10, 3);
  ball.points_mm.emplace_back(100, 0, 0);
  const Difference d = difference(mesh_of(ball), mesh_of(ball));
  EXPECT_LT(d.hausdorff_mm, 1e-14);
  EXPECT_EQ(d.vertex_mm.size(), ball.points_mm.size()) << "each vertex has its value";
  EXPECT_GT(std::abs(d.vertex_mm.back()), 80.0);
}

TEST(Difference, ABoxInABoxHasItsClosedForm) {
  // Every point of the inner one is 1 from the outer; the outer one's corners are sqrt(3) from the inner.
  const Difference d = difference(box_mesh({0, 0, 0}, {8, 8, 8}), box_mesh({1, 1, 1}, {7, 7, 7}),
                                  {.spacing_mm = 0.04, .tolerances_mm = {0.99, 1.01, 2}});
  EXPECT_NEAR(d.b_to_a.mean_mm, 1.0, 1e-13);
  EXPECT_NEAR(d.b_to_a.signed_mean_mm, -1.0, 1e-13);
  EXPECT_NEAR(d.b_to_a.max_mm, 1.0, 1e-13);
  EXPECT_NEAR(d.a_to_b.max_mm, std::sqrt(3.0), 1e-13);
  EXPECT_EQ(d.hausdorff_mm, d.a_to_b.max_mm);
  EXPECT_GT(d.a_to_b.signed_mean_mm, 1.0);
  EXPECT_EQ(d.b_to_a.within[0], 0.0);
  EXPECT_NEAR(d.b_to_a.within[1], 1.0, 1e-12);
  const double s = std::sqrt(1.01 * 1.01 - 1.0);  // so far over the inner face's edge it is 1.01
  EXPECT_NEAR(d.a_to_b.within[1], (36.0 + 4.0 * 6.0 * s + std::numbers::pi * s * s) / 64.0, 3e-3);
  EXPECT_NEAR(d.a_to_b.within[2], 1.0, 1e-12);
  // Along a side the rim is 1 wide: where it is s from the inner face's edge the distance is sqrt(1 + s * s).
  // Of a face, 36 is at 1, four strips of 6 by 1 and four corner squares; 95 % falls into the corner squares.
  EXPECT_GT(d.a_to_b.p95_mm, 1.3);
  EXPECT_LT(d.a_to_b.p95_mm, std::sqrt(2.0));
  EXPECT_EQ(d.hausdorff95_mm, d.a_to_b.p95_mm);
}

TEST(Difference, WeighsByAreaAndNotByTriangles) {
  // One side of the box is split a thousandfold and lies off; nothing may change but the summing.
  Triangles fine = shapes::box({0, 0, 0}, {1, 1, 1});
  for (int split = 0; split < 5; ++split) {
    const std::size_t count = fine.faces.size();
    for (std::size_t f = 0; f < count; ++f) {
      const auto face = fine.faces[f];
      const glm::dvec3 centre =
          (fine.points_mm[face[0]] + fine.points_mm[face[1]] + fine.points_mm[face[2]]) / 3.0;
      if (centre.x < 0.999) continue;
      const auto v = static_cast<std::uint32_t>(fine.points_mm.size());
      fine.points_mm.push_back(centre);
      fine.faces[f] = {face[0], face[1], v};
      fine.faces.push_back({face[1], face[2], v});
      fine.faces.push_back({face[2], face[0], v});
    }
  }
  const Mesh other = box_mesh({0, 0, 0}, {2, 1, 1});
  const Difference of_fine = difference(mesh_of(fine), other),
                   of_coarse = difference(box_mesh({0, 0, 0}, {1, 1, 1}), other);
  EXPECT_GT(fine.faces.size(), 400u);
  EXPECT_NEAR(of_fine.a_to_b.mean_mm, of_coarse.a_to_b.mean_mm, 1e-3 * of_coarse.a_to_b.mean_mm);
}

TEST(Difference, ABallGrownByAMillimetreReadsAMillimetre) {
  const Mesh ball = mesh_of(shapes::sphere({5, -3, 8}, 40, 5));
  const Difference d = difference(moved_along_normals(ball, 1.0), ball, {.spacing_mm = 2.0});
  EXPECT_NEAR(d.a_to_b.signed_mean_mm, 1.0, 1e-3);
  EXPECT_NEAR(d.b_to_a.signed_mean_mm, -1.0, 1e-3);
  EXPECT_NEAR(d.mean_mm, 1.0, 1e-3);
  EXPECT_NEAR(d.hausdorff95_mm, 1.0, 1e-3);
  for (const double vertex : d.vertex_mm) ASSERT_NEAR(vertex, 1.0, 1e-3);
}

TEST(Difference, AFaceMovedAMillimetreAlongItsNormalsReadsAMillimetre) {
  OCTOTOMY_NEEDS_DATA("meshes/fran_cut.vtk");
  Triangles face = read_triangles(tests::reference_data("meshes/fran_cut.vtk"));
  for (glm::dvec3& p : face.points_mm) p *= 1000.0;  // the file is in metres
  const Mesh still = mesh_of(face);
  for (const double by_mm : {1.0, -1.0}) {
    const Difference d = difference(moved_along_normals(still, by_mm), still, {.spacing_mm = 1.0});
    // The vertices are a millimetre apart. Their triangles, about 5 mm long, are nearer to each other by the
    // cosine of half the angle at their edges.
    std::vector<double> vertex_mm = d.vertex_mm;
    const auto middle = vertex_mm.begin() + static_cast<std::ptrdiff_t>(vertex_mm.size() / 2);
    std::nth_element(vertex_mm.begin(), middle, vertex_mm.end());
    EXPECT_NEAR(*middle, by_mm, 5e-3);
    EXPECT_NEAR(d.a_to_b.signed_mean_mm, by_mm, 0.03);
    EXPECT_NEAR(d.b_to_a.mean_mm, 1.0, 0.03);
    EXPECT_NEAR(d.a_to_b.p95_mm, 1.0, 0.01);
  }
}

TEST(Difference, TheHistogramHasAllOfTheAreaAndItsBinsLieAboutZero) {
  const Difference d = difference(box_mesh({0, 0, 0}, {4, 4, 4}), box_mesh({0.5, 0, 0}, {4.5, 4, 4}),
                                  {.spacing_mm = 0.02, .bins = 5});
  EXPECT_NEAR(std::accumulate(d.histogram.shares.begin(), d.histogram.shares.end(), 0.0), 1.0, 1e-10);
  EXPECT_NEAR(d.histogram.low_mm, -0.5, 1e-12);
  EXPECT_NEAR(d.histogram.width_mm, 0.2, 1e-12);
  // The side at x = 4 lies inside the other box, half a millimetre deep but near its rim; that at x = 0 as
  // far outside, and with it strips 0.2 mm wide of the four sides about it; the rest of those lies in the
  // others.
  EXPECT_NEAR(d.histogram.shares[0], 3.4 * 3.4 / 96.0, 3e-3);
  EXPECT_NEAR(d.histogram.shares[4], (16.0 + 4 * 4 * 0.2) / 96.0, 3e-3);
  EXPECT_GT(d.histogram.shares[2], 4 * 14.0 / 96.0);
}

TEST(Difference, AShiftIsSeenThoughVolumesAndAreasAreTheSame) {
  const Mesh mesh = mesh_of(shapes::sphere({0, 0, 0}, 20, 4));
  const Difference d = difference(mesh, moved(mesh, glm::translate(glm::dmat4(1.0), glm::dvec3(0.5, 0, 0))),
                                  {.spacing_mm = 0.5});
  EXPECT_NEAR(d.hausdorff_mm, 0.5, 1e-2);
  EXPECT_NEAR(d.mean_mm, 0.25, 5e-3);  // the mean of |cos| over a sphere is a half
}

TEST(Difference, ThreadsDoNotChangeTheBits) {
  const Mesh a = mesh_of(shapes::sphere({0, 0, 0}, 20, 3)), b = box_mesh({-15, -15, -15}, {15, 15, 15});
  const DifferenceOptions options{.spacing_mm = 0.5};
  const Difference many = difference(a, b, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Difference alone = difference(a, b, options);
  EXPECT_EQ(many.mean_mm, alone.mean_mm);
  EXPECT_EQ(many.hausdorff95_mm, alone.hausdorff95_mm);
  EXPECT_EQ(many.vertex_mm, alone.vertex_mm);
}

TEST(Difference, ASliverTakesNoMoreSamplesThanItsSurfaceAndNoMoreThanCanBeHeld) {
  Triangles needle = triangles_of(mesh_of(shapes::sphere({0, 0, 0}, 10, 4)));
  needle.points_mm.front().z = 1e8;
  const Linked surface = linked(needle);
  EXPECT_LT(difference(surface, surface).sample_count, 4'000'000u);
  DifferenceOptions finer;
  finer.spacing_mm = 10.0;
  try {
    difference(surface, surface, finer);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Resource) << error.what();
  }
}

TEST(Difference, RefusesWhatHasNoAreaAndOptionsOutOfRange) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(difference(mesh, Mesh()), std::invalid_argument);
  EXPECT_THROW(difference(Mesh(), mesh), std::invalid_argument);
  EXPECT_THROW(difference(mesh, mesh, {.spacing_mm = 0.0}), std::invalid_argument);
  EXPECT_THROW(difference(mesh, mesh, {.tolerances_mm = {2, 1}}), std::invalid_argument);
  EXPECT_THROW(difference(mesh, mesh, {.bins = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
