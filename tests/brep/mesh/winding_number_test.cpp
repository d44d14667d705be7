// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/winding_number.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/brep/bad_meshes.h"

namespace octotomy::brep {
namespace {

using shapes::inside_out;
using shapes::sphere;
using shapes::together;

std::vector<glm::dvec3> points_about(double reach, std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-reach, reach);
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < count; ++i) points.emplace_back(any(random), any(random), any(random));
  return points;
}

TEST(WindingNumber, IsOneInsideOfAClosedSurfaceZeroOutsideAndNegativeInsideOut) {
  const Triangles ball = sphere({0, 0, 0}, 5, 5);
  const std::vector<glm::dvec3> points = points_about(8, 2000);
  const std::vector<double> inside = WindingTree(ball).at(points),
                            turned = WindingTree(inside_out(ball)).at(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double away = glm::length(points[i]) - 5.0;
    if (std::abs(away) < 0.02) continue;
    ASSERT_NEAR(inside[i], away < 0.0 ? 1.0 : 0.0, 0.05) << "point " << i;
    ASSERT_NEAR(turned[i], -inside[i], 1e-12);
  }
}

TEST(WindingNumber, OfHalfASphereAtItsMiddleIsAHalf) {
  Triangles half = sphere({0, 0, 0}, 5, 4);
  std::erase_if(half.faces, [&](const auto& f) {
    return half.points_mm[f[0]].z + half.points_mm[f[1]].z + half.points_mm[f[2]].z > 0.0;
  });
  EXPECT_NEAR(WindingTree(half).at({{0, 0, 0}})[0], 0.5, 0.05);
}

TEST(WindingNumber, CountsShellsInShellsAndNothingOfNothing) {
  const Triangles two = together(sphere({0, 0, 0}, 5, 3), sphere({1, 0, 0}, 3, 3));
  EXPECT_NEAR(WindingTree(two).at({{1, 0, 0}})[0], 2.0, 0.05);
  EXPECT_EQ(WindingTree(Triangles{}).at({{1, 0, 0}})[0], 0.0);
}

}  // namespace
}  // namespace octotomy::brep
