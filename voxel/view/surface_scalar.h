// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/measure/distance_map.h"

namespace octotomy::voxel {

/// A number at every voxel of a range. It colours a surface: blue at -most, near white at 0, orange at +most.
struct SurfaceScalar {
  Universe universe;
  VoxelRange range;
  std::vector<float> values;  ///< x fastest
  /// Limit of the colours, above 0; values beyond it have the colour of the limit.
  double most = 1.0;

  /// The value at a position in the universe's index space: trilinear between voxel centres; beyond the
  /// range, the value of the nearest voxel.
  double at(const glm::dvec3& p_voxel) const;
};

/// Signed distances in millimetres to the surface of `other`, negative inside, around the voxels of `object`.
/// They colour the surface of `object` by its distance from `other` (thesis 9.2.3.2). They have the accuracy
/// of signed_distances_mm(). Throws std::invalid_argument if `most_mm` is not positive, the universes differ
/// or an octree is empty. Memory: 12 bytes per voxel of the object's extents.
SurfaceScalar distance_to(const Octree& other, const Octree& object, double most_mm);

/// The sRGB colour of a number from -1 (blue) through 0 (near white) to 1 (orange), along straight lines in
/// CIE Lab. People with any type of colour vision can distinguish the two hues, and both ends are equally
/// dark (after Moreland, ISVC 2009).
glm::vec3 diverging_colour(double share);

/// `count` colours for evenly spaced numbers from -1 to 1.
std::vector<glm::vec3> diverging_colours(int count);

}  // namespace octotomy::voxel
