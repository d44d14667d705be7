// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sample_surface.h"

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

TEST(SampleSurface, AreasAddUpAndNoCornerIsFurtherThanTheReach) {
  const Mesh mesh = mesh_of(shapes::box({-3, 0, 1}, {5, 2, 2.5}));
  for (const double spacing : {20.0, 1.0, 0.3}) {
    const SurfaceSamples samples = sample_surface(mesh, spacing);
    EXPECT_NEAR(std::accumulate(samples.areas_mm2.begin(), samples.areas_mm2.end(), 0.0),
                measure(mesh).area_mm2, 1e-10);
    for (const double distance : SurfaceTree(mesh).distances_mm(samples.points_mm))
      EXPECT_LT(distance, 1e-14);
    double worst = 0.0;
    for (const auto v : mesh.vertices()) {
      double nearest = INFINITY;
      for (const glm::dvec3& p : samples.points_mm)
        nearest = std::min(nearest, glm::distance(p, {mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]}));
      worst = std::max(worst, nearest);
    }
    EXPECT_LE(worst, samples.reach_mm) << "spacing " << spacing;
    EXPECT_GT(worst, 0.2 * samples.reach_mm) << "spacing " << spacing;
  }
}

TEST(SampleSurface, NormalsLookOutward) {
  const SurfaceSamples samples = sample_surface(mesh_of(shapes::sphere({1, 2, 3}, 2, 2)), 0.2);
  ASSERT_GT(samples.points_mm.size(), 1000u);
  for (std::size_t i = 0; i < samples.points_mm.size(); ++i)
    EXPECT_GT(glm::dot(samples.normals[i], samples.points_mm[i] - glm::dvec3(1, 2, 3)), 1.9) << i;
}

TEST(SampleSurface, RefusesNoSpacing) {
  EXPECT_THROW(sample_surface(mesh_of(shapes::box({0, 0, 0}, {1, 1, 1})), 0.0), std::invalid_argument);
}

TEST(SampleSurface, RefusesMoreSamplesThanCanBeHeldAndTellsThePlace) {
  Triangles slivers{{{0, 0, 0}, {1, 0, 0}, {5, 1, 0}, {0, 0, 4.3e10}}, {{0, 1, 2}, {2, 1, 3}}};
  try {
    sample_surface(slivers, 10.0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Resource);
    EXPECT_NE(std::string(error.what()).find("(5, 1, 0) mm, which is 4.3e+10 mm long"), std::string::npos)
        << error.what();
  }
  const Triangles square{{{0, 0, 0}, {8.2e4, 0, 0}, {0, 8.2e4, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(sample_surface(square, 10.0), Error);
}

TEST(SampleSurface, SliversTakeSamplesByTheirAreaAndTheirLengthNotByTheSquareOfIt) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  const auto sliver = [&](double length_mm, double height_mm, double foot) {
    const glm::dmat3 turn =
        glm::mat3_cast(glm::normalize(glm::dquat(any(random), any(random), any(random), any(random) - 0.5)));
    return Triangles{{turn * glm::dvec3(3, 1, 2), turn * glm::dvec3(3 + length_mm, 1, 2),
                      turn * glm::dvec3(3 + foot * length_mm, 1 + height_mm, 2)},
                     {{0, 1, 2}}};
  };
  for (const double height_mm : {1e-9, 0.01, 0.4, 3.0, 20.0})
    for (const double foot : {0.0, 1e-6, 0.02, 0.5, 0.9, 1.0}) {
      SCOPED_TRACE(std::to_string(height_mm) + " mm, foot at " + std::to_string(foot));
      const double length_mm = 500.0;
      const Triangles triangles = sliver(length_mm, height_mm, foot);
      const auto& p = triangles.points_mm;
      const double area_mm2 = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
      const SurfaceSamples samples = sample_surface(triangles, 1.0);
      EXPECT_LE(static_cast<double>(samples.points_mm.size()), 4.0 * area_mm2 + 4.0 * length_mm);
      EXPECT_LE(samples.reach_mm, 2.0 / 3.0);
      EXPECT_NEAR(std::accumulate(samples.areas_mm2.begin(), samples.areas_mm2.end(), 0.0), area_mm2,
                  1e-12 * area_mm2);
      glm::dvec3 moment(0.0);
      for (std::size_t i = 0; i < samples.points_mm.size(); ++i)
        moment += samples.areas_mm2[i] / area_mm2 * samples.points_mm[i];
      EXPECT_LT(glm::distance(moment, (p[0] + p[1] + p[2]) / 3.0), 1e-9 * length_mm);
      for (int trial = 0; trial < 300; ++trial) {
        double u = any(random), v = any(random);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        const glm::dvec3 place = p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
        double nearest = INFINITY;
        for (const glm::dvec3& sample : samples.points_mm)
          nearest = std::min(nearest, glm::distance(place, sample));
        ASSERT_LE(nearest, samples.reach_mm + 1e-9) << u << ", " << v;
      }
    }
}

TEST(SampleSurface, AWidenedSpacingTakesNoMoreOfSliversAndLeavesOtherSurfacesAlone) {
  const Triangles ball = triangles_of(mesh_of(shapes::sphere({0, 0, 0}, 10, 4)));
  EXPECT_EQ(widened_spacing_mm(ball, 0.5, 64.0 * 8.0 * 1256.0), 0.5);
  for (const double length_mm : {1e3, 1e6, 3e11}) {
    Triangles needle = ball;
    needle.points_mm.front().z = length_mm;
    const double wanted = 20000.0;
    const double spacing_mm = std::sqrt(2.0 * size_of(needle).area_mm2 / wanted);
    const SurfaceSamples samples =
        sample_surface(needle, widened_spacing_mm(needle, spacing_mm, 64.0 * wanted));
    EXPECT_GT(samples.points_mm.size(), 1000u) << length_mm;
    EXPECT_LT(samples.points_mm.size(), 80.0 * wanted) << length_mm;
    EXPECT_NEAR(std::accumulate(samples.areas_mm2.begin(), samples.areas_mm2.end(), 0.0),
                size_of(needle).area_mm2, 1e-9 * size_of(needle).area_mm2);
  }
}

}  // namespace
}  // namespace octotomy::brep
