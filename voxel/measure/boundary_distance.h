// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Distances from points to the boundary of an octree's voxels, faces of cavities included. Beyond the
/// universe there are no voxels. Keeps the octree; any number of threads may ask one.
class BoundaryDistance {
 public:
  /// Throws std::invalid_argument if the universe's axes are not perpendicular.
  explicit BoundaryDistance(const Octree& octree);

  /// Millimetres from a point in LPS to the nearest face; infinity where the octree is empty. Any number
  /// below `enough_mm` stands for all of them: the search ends with the first that it finds. Cost: up to 27
  /// look-ups within a voxel of the boundary, further away a walk from the root.
  double operator()(const glm::dvec3& p_mm, double enough_mm = 0.0) const;

 private:
  Octree octree_;
  glm::dmat4 voxel_from_lps_;
  glm::dvec3 spacing_mm_;
};

}  // namespace octotomy::voxel
