// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// Voxels low..high, both included.
struct VoxelRange {
  glm::ivec3 low{0};
  glm::ivec3 high{-1};

  bool is_empty() const { return glm::any(glm::greaterThan(low, high)); }
  glm::ivec3 dims() const { return high - low + 1; }
  bool operator==(const VoxelRange&) const = default;
};

/// The least range that holds every voxel of the octree; empty where there is none.
VoxelRange range_of(const Octree& octree);

/// The range with so many voxels more on every side; it may leave the universe.
VoxelRange grown(const VoxelRange& range, int voxels);

/// Squares of distances in square millimetres, from each voxel's centre to the nearest centre of a voxel of a
/// set, over a range of voxels, x fastest; infinity where the set is empty.
struct DistanceMap {
  VoxelRange range;
  std::vector<float> square_mm2;

  std::size_t index(const glm::ivec3& voxel) const;
};

/// Distances to the octree's voxels. Voxels outside the universe are not in the set. The range may reach
/// beyond the universe. Exact (the nearest voxel is the nearest) but for the rounding of sums of squares:
/// each float is within two units in the last place of a float. Preconditions: axes of the universe at right
/// angles; throws std::invalid_argument where they are not. Parallel; same bits on any thread count. Cost:
/// three passes over the range, 4 bytes a voxel. Source: Felzenszwalb and Huttenlocher, Theory of Computing
/// 8, 2012.
DistanceMap distance_map(const Octree& octree, const VoxelRange& range);

/// The same to the voxels that are not in the octree, those beyond the universe among them.
DistanceMap distance_map_of_complement(const Octree& octree, const VoxelRange& range);

/// From a map that is zero at the voxels of a set and infinite at all others, their distances: what
/// distance_map() does with an octree's voxels.
void spread(DistanceMap& map, const Universe& universe);

/// The voxels of the range, and of the universe, whose square distance is wanted.
Octree octree_where(const Universe& universe, const DistanceMap& map,
                    const std::function<bool(double square_mm2)>& wanted);

/// Signed distances in millimetres from the set's surface, negative inside: between centres of voxels inside
/// and outside the surface lies in the middle, so that a voxel's value is its distance to the nearest voxel
/// of the other side less (inside: plus, negative) half of the distance that neighbours along the axis of
/// least spacing have. Voxels beyond the universe are outside. Over the range, x fastest.
std::vector<float> signed_distances_mm(const Octree& octree, const VoxelRange& range);

}  // namespace octotomy::voxel
