// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Distances from points to the boundary of an octree's voxels, including the faces of cavities. Voxels
/// beyond the universe count as outside. Stores a copy of the octree. Any number of threads may call it.
class BoundaryDistance {
 public:
  /// Throws std::invalid_argument if the universe's axes are not perpendicular.
  explicit BoundaryDistance(const Octree& octree);

  /// Distance in millimetres from a point in LPS to the nearest face; infinity if the octree is empty. The
  /// search stops at the first face nearer than `enough_mm` and returns its distance. Cost: up to 27 look-ups
  /// for points within a voxel of the boundary; for others, a walk from the root.
  double operator()(const glm::dvec3& p_mm, double enough_mm = 0.0) const;

 private:
  Octree octree_;
  glm::dmat4 voxel_from_lps_;
  glm::dvec3 spacing_mm_;
};

}  // namespace octotomy::voxel
