// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/boundary_distance.h"

#include <gtest/gtest.h>
#include <random>

#include "voxel/solid/combine.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

Universe turned_universe(int depth) {
  Universe universe;
  universe.depth = depth;
  universe.lps_from_voxel =
      glm::dmat4({0.0, 0.6, 0.8, 0.0}, {1.5, 0.0, 0.0, 0.0}, {0.0, -1.6, 1.2, 0.0}, {-7.0, 3.0, 11.0, 1.0});
  return universe;
}

double distance_to_faces(const Octree& octree, const glm::dvec3& p_mm) {
  const Lattice lattice = octree.universe().lattice();
  const glm::dvec3 p = lattice.voxel(p_mm);
  double nearest = std::numeric_limits<double>::infinity();
  for (const VoxelFace& face : voxel_boundary(octree)) {
    glm::dvec3 half(0.5), centre(face.voxel);
    half[face.axis] = 0.0;
    centre[face.axis] += 0.5 * face.side;
    const glm::dvec3 apart = glm::max(glm::abs(p - centre) - half, 0.0) * lattice.spacing_mm();
    nearest = std::min(nearest, glm::length(apart));
  }
  return nearest;
}

TEST(BoundaryDistance, IsThatToTheNearestOfAllFacesNearAndFarInsideAndOutside) {
  std::mt19937 random(7);
  for (const int depth : {4, 5, 6}) {
    const Universe universe = turned_universe(depth);
    const double side = universe.side();
    const auto point = [&](double beyond) {
      std::uniform_real_distribution<double> place(-0.5 - beyond, side - 0.5 + beyond);
      return universe.lattice().lps_mm({place(random), place(random), place(random)});
    };
    for (int i = 0; i < 12; ++i) {
      const Expression balls =
          (Expression(Sphere{point(0.0), 0.25 * side}) - Sphere{point(0.0), 0.15 * side}) |
          Sphere{point(0.0), 2.0};
      const Octree octree = combine(universe, balls);
      if (octree.is_empty()) continue;
      const BoundaryDistance distance(octree);
      for (int j = 0; j < 60; ++j) {
        const glm::dvec3 p_mm = point(j % 3 == 0 ? side : 0.0);
        const double truth = distance_to_faces(octree, p_mm);
        EXPECT_NEAR(distance(p_mm), truth, 1e-9 * side) << depth << ' ' << i << ' ' << j;
        const double rough = distance(p_mm, 2.0);
        EXPECT_TRUE(rough < 2.0 ? truth <= rough + 1e-9 : std::abs(rough - truth) < 1e-9 * side) << rough;
      }
    }
  }
}

TEST(BoundaryDistance, OfAFullUniverseIsThatToItsBorderAndOfAnEmptyOneInfinite) {
  for (const int depth : {4, 5}) {
    const Universe universe = turned_universe(depth);
    const BoundaryDistance of_full(Octree::full(universe));
    const glm::dvec3 centre(0.5 * universe.side() - 0.5);
    EXPECT_NEAR(of_full(universe.lattice().lps_mm(centre)), 0.5 * universe.side(), 1e-9);
    EXPECT_NEAR(of_full(universe.lattice().lps_mm({-3.5, 1.0, 1.0})), 3.0, 1e-9);
    EXPECT_TRUE(std::isinf(BoundaryDistance(Octree::empty(universe))({0, 0, 0})));
  }
}

TEST(BoundaryDistance, ShearedAxesAreRefused) {
  Universe universe;
  universe.lps_from_voxel[1][0] = 0.1;
  EXPECT_THROW(BoundaryDistance(Octree::full(universe)), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::voxel
