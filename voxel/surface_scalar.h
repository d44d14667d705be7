// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/distance_map.h"

namespace octotomy::voxel {

/// A number at every voxel of a range, by which a surface is coloured: from -most, blue, through 0, near
/// white, to most, orange.
struct SurfaceScalar {
  Universe universe;
  VoxelRange range;
  std::vector<float> values;  ///< x fastest
  double most = 1.0;          ///< positive; what is larger has the last colour

  /// Trilinear between voxels' centres; beyond the range that of its nearest voxel. Index space of the
  /// universe.
  double at(const glm::dvec3& p_voxel) const;
};

/// Signed distances in millimetres, negative inside, to the surface of `other`, about the voxels of `object`:
/// how far the object's surface lies outside or inside the other one's (thesis 9.2.3.2). As exact as voxels
/// are: signed_distances_mm(). Throws std::invalid_argument where `most_mm` is not positive, the universes
/// differ or either octree is empty. Memory: 12 bytes a voxel of the object's extents.
SurfaceScalar distance_to(const Octree& other, const Octree& object, double most_mm);

/// Colour, sRGB, of a share of the range from -1 to 1: straight lines in CIE Lab from blue to orange, which
/// readers of any colour vision tell apart, both ends equally dark (after Moreland, ISVC 2009).
glm::vec3 diverging_colour(double share);

/// So many colours of the whole range, from -1 to 1.
std::vector<glm::vec3> diverging_colours(int count);

}  // namespace octotomy::voxel
