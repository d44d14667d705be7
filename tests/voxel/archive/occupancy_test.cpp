// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/occupancy.h"

#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "voxel/codes/run_length.h"

namespace octotomy::voxel {
namespace {

Universe universe_of(double edge_mm, const glm::dvec3& first_mm) {
  Universe universe;
  universe.depth = 3;
  universe.lps_from_voxel = glm::dmat4(edge_mm);
  universe.lps_from_voxel[3] = glm::dvec4(first_mm, 1.0);
  return universe;
}

Octree voxels(const Universe& universe, std::vector<std::uint64_t> indices) {
  RunLength runs{universe, {}};
  for (const std::uint64_t i : indices) runs.runs.push_back({i, i});
  return octree_of(runs);
}

TEST(Occupancy, OneVoxelIsSharedByTheVoxelsThatItLiesIn) {
  // A cube of 1 mm about (0.5, 0, 0): half of it in each of two voxels of 1 x 2 x 1 mm.
  const auto shares = occupancy(voxels(universe_of(1.0, {0.5, 0.0, 0.0}), {0}),
                                axis_aligned_lattice({3, 2, 1}, {1, 2, 1}, {0, 0, 0}));
  ASSERT_TRUE(shares);
  EXPECT_EQ(*shares, (std::vector<double>{0.25, 0.25, 0, 0, 0, 0}));
}

TEST(Occupancy, AddsUpToTheVolumeWhateverTheAxesOrder) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::vector<std::uint64_t> set;
    for (std::uint64_t i = 0; i < 512; ++i)
      if (random() % 3 == 0 && (set.empty() || set.back() + 1 != i)) set.push_back(i);
    const Octree octree = voxels(universe_of(0.7, {-1.3, 2.1, 0.4}), set);
    Lattice lattice{{9, 14, 5}, glm::dmat4(1.0)};
    const int x = static_cast<int>(seed % 3), y = (x + 1 + static_cast<int>(seed / 3 % 2)) % 3, z = 3 - x - y;
    const double sign = seed % 2 == 0 ? 1.0 : -1.0;
    glm::dvec3 first(0.0);
    for (const auto& [column, axis, step] : {std::tuple{0, x, 1.1 * sign}, {1, y, 0.53}, {2, z, 1.9}}) {
      glm::dvec4 direction(0.0);
      direction[axis] = step;
      lattice.lps_from_voxel[column] = direction;
      // Around the octree's middle.
      const glm::dvec3 middle = octree.universe().lattice().lps_mm(glm::dvec3(3.5));
      first[axis] = middle[axis] - 0.5 * step * (lattice.dims[column] - 1);
    }
    lattice.lps_from_voxel[3] = glm::dvec4(first, 1.0);
    const auto shares = occupancy(octree, lattice);
    ASSERT_TRUE(shares);
    const double sum = std::accumulate(shares->begin(), shares->end(), 0.0) * lattice.voxel_mm3();
    EXPECT_NEAR(sum, static_cast<double>(octree.voxel_count()) * 0.343, 1e-9);
    for (const double share : *shares) {
      EXPECT_GE(share, 0.0);
      EXPECT_LE(share, 1.0 + 1e-12);
    }
  }
}

TEST(Occupancy, IsNoneOfATurnedLattice) {
  Lattice turned = axis_aligned_lattice({4, 4, 4}, {1, 1, 1}, {0, 0, 0});
  turned.lps_from_voxel[0] = {0.8, 0.6, 0, 0};
  turned.lps_from_voxel[1] = {-0.6, 0.8, 0, 0};
  EXPECT_FALSE(occupancy(Octree::full(universe_of(1.0, {0, 0, 0})), turned));
}

}  // namespace
}  // namespace octotomy::voxel
