// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/sample_surface.h"

#include <gtest/gtest.h>
#include <numeric>

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
  slivers.points_mm[3].z = 4.3e4;
  EXPECT_GT(sample_surface(slivers, 10.0).points_mm.size(), 4300u * 4300u);
}

}  // namespace
}  // namespace octotomy::brep
