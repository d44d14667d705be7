// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/smooth.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

Mesh noisy_ball(double noise_mm) {
  Triangles ball = shapes::sphere({3, -4, 5}, 20.0, 4);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-noise_mm, noise_mm);
  for (glm::dvec3& p : ball.points_mm) p += noise(random) * glm::normalize(p - glm::dvec3(3, -4, 5));
  return mesh_of(ball);
}

double roughness_mm(const Mesh& mesh) {
  double squares = 0.0;
  for (const auto vertex : mesh.vertices()) {
    const double off = (mesh.point(vertex) - Mesh::Point(3, -4, 5)).norm() - 20.0;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(mesh.n_vertices()));
}

TEST(Smooth, NoiseGoesAndTheVolumeStaysWithinItsShare) {
  const Mesh noisy = noisy_ball(0.3);
  SmoothOptions options;
  options.max_volume_share = 0.003;
  const Mesh smoothed = smooth(noisy, options);
  EXPECT_LT(roughness_mm(smoothed), 0.4 * roughness_mm(noisy));
  EXPECT_NEAR(volume_mm3(smoothed), volume_mm3(noisy), 0.003 * volume_mm3(noisy));
  EXPECT_TRUE(health(smoothed).solid());
  EXPECT_EQ(triangles_of(smoothed).faces, triangles_of(noisy).faces);
}

TEST(Smooth, AVolumeThatChangesByMoreThanItsShareIsRefused) {
  SmoothOptions options;
  EXPECT_THROW(smooth(mesh_of(shapes::box({0, 0, 0}, {10, 10, 10})), options), std::runtime_error)
      << "a box of twelve triangles has no wave long enough to stay";
  options.max_volume_share = 10.0;
  EXPECT_NO_THROW(smooth(mesh_of(shapes::box({0, 0, 0}, {10, 10, 10})), options));
}

TEST(Smooth, AnOpenMeshKeepsItsBorderAndLosesItsNoise) {
  Triangles cap = triangles_of(noisy_ball(0.3));
  std::erase_if(cap.faces, [&](const auto& f) { return cap.points_mm[f[0]].z < 5.0; });
  const Mesh open = mesh_of(cap), smoothed = smooth(open);
  std::size_t border = 0, moved = 0;
  for (const auto vertex : open.vertices()) {
    if (open.is_isolated(vertex)) continue;
    border += open.is_boundary(vertex);
    moved += open.point(vertex) != smoothed.point(vertex);
    if (open.is_boundary(vertex)) {
      EXPECT_EQ(open.point(vertex), smoothed.point(vertex));
    }
  }
  EXPECT_GT(border, 10U);
  EXPECT_GT(moved, 10U * border / 2);
  EXPECT_LT(roughness_mm(smoothed), roughness_mm(open));
}

TEST(Smooth, OptionsOutOfRangeAreRefused) {
  SmoothOptions options;
  options.pass_band = 1.0;
  EXPECT_THROW(smooth(noisy_ball(0.1), options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
