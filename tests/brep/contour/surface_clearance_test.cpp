// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/surface_clearance.h"

#include <gtest/gtest.h>
#include <random>

namespace octotomy::brep {
namespace {

TEST(SurfaceClearance, CountsTrianglesBetweenTheEndsInSpaceAndNotInProjection) {
  // Two triangles over each other.
  const SurfaceClearance roof(
      {{{0, 0, 1}, {10, 0, 1}, {0, 10, 1}, {0, 0, 2}, {10, 0, 2}, {0, 10, 2}}, {{0, 1, 2}, {3, 4, 5}}});
  EXPECT_EQ(roof.crossed({2, 2, 0}, {3, 3, 3}, 6), 2);
  EXPECT_EQ(roof.crossed({3, 3, 3}, {2, 2, 0}, 6), 2) << "either way";
  EXPECT_EQ(roof.crossed({2, 2, 0}, {3, 3, 3}, 1), 1) << "no more than asked for";
  EXPECT_EQ(roof.crossed({2, 2, 0}, {3, 3, 1.5}, 6), 1);
  EXPECT_EQ(roof.crossed({-5, 3, 0.5}, {15, 3, 0.9}, 6), 0) << "below";
  EXPECT_EQ(roof.crossed({9, 9, 0}, {9, 9, 3}, 6), 0) << "beside";
  EXPECT_EQ(SurfaceClearance({}).crossed({0, 0, 0}, {1, 1, 1}, 6), 0);
}

TEST(SurfaceClearance, CountsAsATestOfAllTrianglesDoes) {
  int crossed = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-10.0, 10.0);
    const auto point = [&] { return glm::dvec3(any(random), any(random), any(random)); };
    Triangles noise;
    for (std::uint32_t f = 0; f < 40; ++f) {
      for (int k = 0; k < 3; ++k) noise.points_mm.push_back(point());
      noise.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const SurfaceClearance surface(noise);
    for (int trial = 0; trial < 100; ++trial) {
      const glm::dvec3 a = point(), b = point();
      // Solves a + t (b - a) = p + u (q - p) + v (r - p), by Cramer's rule.
      int expected = 0;
      for (const auto& face : noise.faces) {
        const glm::dvec3 p = noise.points_mm[face[0]], q = noise.points_mm[face[1]] - p,
                         r = noise.points_mm[face[2]] - p;
        const glm::dmat3 sides(a - b, q, r);
        const glm::dvec3 found = glm::inverse(sides) * (a - p);
        expected +=
            found.x > 0.0 && found.x < 1.0 && found.y > 0.0 && found.z > 0.0 && found.y + found.z < 1.0;
      }
      ASSERT_EQ(surface.crossed(a, b, 100), expected) << "seed " << seed << ", trial " << trial;
      crossed += expected;
    }
  }
  EXPECT_GT(crossed, 1000);
}

}  // namespace
}  // namespace octotomy::brep
