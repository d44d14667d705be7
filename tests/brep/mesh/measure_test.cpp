// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/measure.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

TEST(Measure, ABoxHasItsClosedForms) {
  const Measures m = measure(mesh_of(shapes::box({-1, 2, -3}, {2, 4, 1})));
  EXPECT_NEAR(m.volume_mm3, 24.0, 1e-13 * 24);
  EXPECT_NEAR(m.area_mm2, 2 * (3 * 2 + 2 * 4 + 3 * 4), 1e-13 * 52);
  EXPECT_EQ(volume_mm3(mesh_of(shapes::box({-1, 2, -3}, {2, 4, 1}))), m.volume_mm3);
  ASSERT_TRUE(m.centroid_mm);
  EXPECT_LT(glm::distance(*m.centroid_mm, glm::dvec3(0.5, 3, -1)), 1e-14);
  EXPECT_EQ(m.low_mm, glm::dvec3(-1, 2, -3));
  EXPECT_EQ(m.high_mm, glm::dvec3(2, 4, 1));
  EXPECT_NEAR(m.absolute_mean_curvature_mm, pi * (3 + 2 + 4), 1e-12);
}

TEST(Measure, InertiaOfABoxAndOfATurnedOneHasItsClosedForm) {
  const glm::dvec3 edges(3, 2, 4);
  const Mesh box = mesh_of(shapes::box(glm::dvec3(7, -5, 1), glm::dvec3(7, -5, 1) + edges));
  const glm::dvec3 squares = edges * edges * 24.0 / 12.0;
  const glm::dmat3 wanted(squares.y + squares.z, 0, 0, 0, squares.z + squares.x, 0, 0, 0,
                          squares.x + squares.y);
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), 0.9, glm::normalize(glm::dvec3(1, -2, 0.5))));
  const glm::dmat3 still = measure(box).inertia_mm5.value();
  const glm::dmat3 turned = measure(moved(box, glm::dmat4(turn))).inertia_mm5.value();
  const glm::dmat3 wanted_turned = turn * wanted * glm::transpose(turn);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(still[c][r], wanted[c][r], 1e-11);
      EXPECT_NEAR(turned[c][r], wanted_turned[c][r], 1e-11);
    }
}

TEST(Measure, SpheresConvergeToTheirClosedFormsAtSecondOrder) {
  const double r = 5.0;
  double volume_error = 0, area_error = 0, curvature_error = 0;
  for (int splits = 2; splits <= 5; ++splits) {
    const Measures m = measure(mesh_of(shapes::sphere({10, -20, 30}, r, splits)));
    const double volume = 4.0 / 3.0 * pi * r * r * r - m.volume_mm3, area = 4 * pi * r * r - m.area_mm2,
                 curvature = std::abs(4 * pi * r - m.absolute_mean_curvature_mm);
    if (splits > 2) {
      EXPECT_NEAR(volume_error / volume, 4.0, 0.2) << splits << " splits";
      EXPECT_NEAR(area_error / area, 4.0, 0.2) << splits << " splits";
      EXPECT_GT(curvature_error / curvature, 3.5) << splits << " splits";
    }
    volume_error = volume;
    area_error = area;
    curvature_error = curvature;
  }
  EXPECT_LT(volume_error, 1e-3 * 4.0 / 3.0 * pi * r * r * r);
}

TEST(Measure, FarFromTheOriginTheVolumeLosesNoMoreThanThePointsDo) {
  const Mesh here = mesh_of(shapes::sphere({0, 0, 0}, 1, 4));
  const Mesh there = mesh_of(shapes::sphere({1e6, -1e6, 1e6}, 1, 4));
  const double spacing = 1e6 * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(measure(there).volume_mm3, measure(here).volume_mm3, spacing * measure(here).area_mm2);
}

TEST(Measure, OfTrianglesIsThatOfTheirMeshToTheBit) {
  const Triangles surface =
      shapes::together(shapes::sphere({10, -20, 30}, 5, 4), shapes::box({-1, 2, -3}, {2, 4, 1}));
  const Measures of_list = measure(linked(surface)), of_mesh = measure(mesh_of(surface));
  EXPECT_EQ(of_list.volume_mm3, of_mesh.volume_mm3);
  EXPECT_EQ(of_list.area_mm2, of_mesh.area_mm2);
  EXPECT_EQ(of_list.centroid_mm, of_mesh.centroid_mm);
  EXPECT_EQ(of_list.inertia_mm5, of_mesh.inertia_mm5);
  EXPECT_EQ(of_list.low_mm, of_mesh.low_mm);
  EXPECT_EQ(of_list.high_mm, of_mesh.high_mm);
  EXPECT_EQ(of_list.absolute_mean_curvature_mm, of_mesh.absolute_mean_curvature_mm);
}

TEST(Measure, OfOpenTrianglesHaveTheCurvatureOfTheirInnerEdges) {
  Triangles open = shapes::box({0, 0, 0}, {1, 1, 1});
  open.faces.erase(open.faces.begin());
  const Measures of_list = measure(linked(open)), of_mesh = measure(mesh_of(open));
  EXPECT_EQ(of_list.area_mm2, of_mesh.area_mm2);
  EXPECT_NEAR(of_list.absolute_mean_curvature_mm, of_mesh.absolute_mean_curvature_mm, 1e-14);
  EXPECT_LT(of_list.absolute_mean_curvature_mm, 3 * std::numbers::pi - 1.0);
}

TEST(Measure, AMirroredSurfaceHasNegativeVolumeAndTheSameArea) {
  const Triangles sphere = shapes::sphere({1, 1, 1}, 2, 3);
  const Measures out = measure(mesh_of(sphere)), in = measure(mesh_of(shapes::inside_out(sphere)));
  EXPECT_NEAR(in.volume_mm3, -out.volume_mm3, 1e-12);
  EXPECT_NEAR(in.area_mm2, out.area_mm2, 1e-12);
  EXPECT_LT(glm::distance(*in.centroid_mm, *out.centroid_mm), 1e-13);
}

TEST(Measure, NothingHasNoCentroid) {
  const Measures m = measure(Mesh());
  EXPECT_EQ(m.volume_mm3, 0.0);
  EXPECT_FALSE(m.centroid_mm);
  EXPECT_FALSE(m.inertia_mm5);
}

TEST(Measure, RigidMotionsChangeNothing) {
  const Mesh still = mesh_of(shapes::box({-1, -2, -3}, {4, 5, 6}));
  glm::dmat4 motion = glm::translate(glm::dmat4(1.0), glm::dvec3(100, -50, 25));
  motion = glm::rotate(motion, 0.7, glm::normalize(glm::dvec3(1, 2, -3)));
  const Measures a = measure(still), b = measure(moved(still, motion));
  EXPECT_NEAR(a.volume_mm3, b.volume_mm3, 1e-12 * a.volume_mm3);
  EXPECT_NEAR(a.area_mm2, b.area_mm2, 1e-12 * a.area_mm2);
  EXPECT_NEAR(a.absolute_mean_curvature_mm, b.absolute_mean_curvature_mm, 1e-10);
  EXPECT_LT(glm::distance(glm::dvec3(motion * glm::dvec4(*a.centroid_mm, 1.0)), *b.centroid_mm), 1e-12);
}

}  // namespace
}  // namespace octotomy::brep
