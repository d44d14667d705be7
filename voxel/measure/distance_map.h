// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A box of voxels low..high, both included.
struct VoxelRange {
  glm::ivec3 low{0};
  glm::ivec3 high{-1};

  bool is_empty() const { return glm::any(glm::greaterThan(low, high)); }
  glm::ivec3 dims() const { return high - low + 1; }
  bool operator==(const VoxelRange&) const = default;
};

/// The smallest range that contains every voxel of the octree; empty for an empty octree.
VoxelRange range_of(const Octree& octree);

/// The range enlarged by `voxels` on every side; it may extend beyond the universe.
VoxelRange grown(const VoxelRange& range, int voxels);

/// For each voxel of a range, x fastest, the squared distance in mm^2 from its centre to the nearest centre
/// of a voxel of a set; infinity if the set is empty.
struct DistanceMap {
  VoxelRange range;
  std::vector<float> square_mm2;

  std::size_t index(const glm::ivec3& voxel) const;
};

/// Distances to the octree's voxels; voxels outside the universe are not in the set. The range may reach
/// beyond the universe. Exact up to the rounding of sums of squares: each float is within two units in its
/// last place. Throws std::invalid_argument if the universe's axes are not perpendicular. Parallel; same bits
/// on any thread count. Cost: three passes over the range, 4 bytes per voxel. Source: Felzenszwalb and
/// Huttenlocher, Theory of Computing 8, 2012.
DistanceMap distance_map(const Octree& octree, const VoxelRange& range);

/// Distances to the voxels that are not in the octree, voxels beyond the universe included.
DistanceMap distance_map_of_complement(const Octree& octree, const VoxelRange& range);

/// Converts a map that is zero at the voxels of a set and infinite elsewhere into the squared distances to
/// the set. Exceptions and cost are those of distance_map().
void spread(DistanceMap& map, const Universe& universe);

/// The object of the voxels in both range and universe whose squared distance satisfies `wanted`.
Octree octree_where(const Universe& universe, const DistanceMap& map,
                    const std::function<bool(double square_mm2)>& wanted);

/// Signed distances in millimetres from the object's surface, negative inside, over the range, x fastest. The
/// surface lies midway between the centres of voxels inside and outside: a voxel outside has the value d - h
/// and a voxel inside -(d - h), where d is the distance to the nearest voxel on the other side and h half the
/// least spacing. Voxels beyond the universe are outside.
std::vector<float> signed_distances_mm(const Octree& octree, const VoxelRange& range);

}  // namespace octotomy::voxel
