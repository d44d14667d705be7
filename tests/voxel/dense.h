// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "voxel/tree/build.h"
#include "voxel/tree/octree.h"

namespace octotomy::tests {

/// A plain array of voxels, the reference for every octree operation.
struct Dense {
  int side = 0;
  std::vector<std::uint8_t> voxels;

  explicit Dense(int edge) : side(edge), voxels(static_cast<std::size_t>(edge) * edge * edge, 0) {}
  std::uint8_t& at(const glm::ivec3& v) { return voxels[index(v)]; }
  std::uint8_t at(const glm::ivec3& v) const { return voxels[index(v)]; }
  std::size_t index(const glm::ivec3& v) const {
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(side) * (v.y + static_cast<std::size_t>(side) * v.z);
  }
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) visit(glm::ivec3(x, y, z));
  }
};

inline voxel::Octree octree_of(const voxel::Universe& universe, const Dense& dense) {
  voxel::Scene scene;
  scene.lattice = universe.lattice();
  scene.samples = voxel::Int16Samples(dense.voxels.begin(), dense.voxels.end());
  return voxel::octree_of_window(universe, scene, 1, 1);
}

inline Dense dense_of(const voxel::Octree& octree) {
  Dense dense(octree.universe().side());
  dense.for_each([&](const glm::ivec3& v) { dense.at(v) = octree.contains(v); });
  return dense;
}

/// A few balls and boxes, sometimes inverted: homogeneous parts at all levels, curved and flat boundary.
/// One seed in eight gives a single voxel, nothing, everything, or noise.
inline Dense random_dense(int side, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  Dense dense(side);
  switch (below(32)) {
    case 0:
      return dense;
    case 1:
      dense.voxels.assign(dense.voxels.size(), 1);
      return dense;
    case 2:
      dense.at({below(side), below(side), below(side)}) = 1;
      return dense;
    case 3:
      for (std::uint8_t& voxel : dense.voxels) voxel = random() & 1;
      return dense;
    default:
      break;
  }
  const int shapes = 1 + below(4);
  for (int i = 0; i < shapes; ++i) {
    const glm::ivec3 centre(below(side), below(side), below(side));
    const int radius = 1 + below(side / 2);
    const bool ball = below(2) == 0;
    const bool add = below(4) != 0;
    dense.for_each([&](const glm::ivec3& v) {
      const glm::ivec3 d = glm::abs(v - centre);
      const bool inside = ball ? d.x * d.x + d.y * d.y + d.z * d.z <= radius * radius
                               : d.x < radius && 2 * d.y < radius + 3 && d.z <= radius;
      if (inside) dense.at(v) = add;
    });
  }
  if (below(4) == 0)
    for (std::uint8_t& voxel : dense.voxels) voxel ^= 1;
  return dense;
}

}  // namespace octotomy::tests
