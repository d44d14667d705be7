// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/curvature.h"

#include <gtest/gtest.h>
#include <numeric>

#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

TEST(Curvature, ABallsIsOneOverItsRadiusAndTurnsNegativeInsideOut) {
  const Triangles ball = shapes::sphere({1, 2, 3}, 4.0, 4);
  const Curvature out = curvature(mesh_of(ball)), in = curvature(mesh_of(shapes::inside_out(ball)));
  for (std::size_t v = 0; v < ball.points_mm.size(); ++v) {
    ASSERT_TRUE(out.known[v]);
    EXPECT_NEAR(out.mean_per_mm[v], 0.25, 0.002);
    EXPECT_NEAR(out.gaussian_per_mm2[v], 0.0625, 0.002);
    EXPECT_NEAR(in.mean_per_mm[v], -out.mean_per_mm[v], 1e-12);
    EXPECT_NEAR(in.gaussian_per_mm2[v], out.gaussian_per_mm2[v], 1e-12);
    const glm::dvec3 outward = (ball.points_mm[v] - glm::dvec3(1, 2, 3)) / 4.0;
    EXPECT_LT(glm::distance(out.normals[v], outward), 0.005);
    EXPECT_LT(glm::distance(in.normals[v], -outward), 0.005);
  }
}

double total_gaussian(const Curvature& curvature) {
  return std::inner_product(curvature.areas_mm2.begin(), curvature.areas_mm2.end(),
                            curvature.gaussian_per_mm2.begin(), 0.0);
}

TEST(Curvature, ATorusIsASaddleInsideAndConvergesToItsClosedForm) {
  double before = 0.0;
  for (const int fine : {1, 2, 4}) {
    const Triangles ring = shapes::torus(5.0, 2.0, 48 * fine, 24 * fine);
    const Curvature found = curvature(mesh_of(ring));
    double worst = 0.0;
    for (int j = 0; j < 24 * fine; ++j) {
      const double v = 2 * pi * j / (24 * fine), r = 5.0 + 2.0 * std::cos(v);
      const auto point = static_cast<std::size_t>(j);
      worst = std::max(worst, std::abs(found.gaussian_per_mm2[point] - std::cos(v) / (2.0 * r)));
      worst = std::max(worst, std::abs(found.mean_per_mm[point] - 0.5 * (0.5 + std::cos(v) / r)));
    }
    if (fine > 1) {
      EXPECT_GT(before / worst, 3.0) << fine;
    }
    before = worst;
    EXPECT_NEAR(total_gaussian(found), 0.0, 1e-9);
  }
  EXPECT_LT(before, 0.001);
}

TEST(Curvature, TotalsAreThoseOfGaussAndBonnetWhateverTheShape) {
  Triangles blob = shapes::sphere({0, 0, 0}, 3, 2);
  for (glm::dvec3& p : blob.points_mm) p += glm::dvec3(0.3 * std::sin(7 * p.y), 0.2 * p.x * p.z, 0);
  const Curvature of_blob = curvature(mesh_of(blob));
  EXPECT_NEAR(total_gaussian(of_blob), 4 * pi, 1e-10);
  EXPECT_NEAR(std::accumulate(of_blob.areas_mm2.begin(), of_blob.areas_mm2.end(), 0.0),
              size_of(blob).area_mm2, 1e-10);
  EXPECT_NEAR(total_gaussian(curvature(mesh_of(shapes::box({0, 0, 0}, {1, 2, 3})))), 4 * pi, 1e-12);
}

TEST(Curvature, ABorderIsNotKnown) {
  Triangles open = shapes::sphere({0, 0, 0}, 1, 2);
  const auto lost = open.faces.back();
  open.faces.pop_back();
  const Curvature found = curvature(mesh_of(open));
  for (const std::uint32_t v : lost) EXPECT_FALSE(found.known[v]);
  EXPECT_EQ(std::accumulate(found.known.begin(), found.known.end(), std::size_t{0}),
            open.points_mm.size() - 3);
}

}  // namespace
}  // namespace octotomy::brep
