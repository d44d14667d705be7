// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

/// An object to be drawn. Where `grey` is given, depth is interpolated by partial volume at `threshold`
/// (thesis 5.2.2.2), the sample at which the object begins; otherwise, and where the object ends at a cut
/// instead of at the threshold, the surface is the voxels'.
/// Precondition: `grey` is of the octree's universe.
struct Drawn {
  std::string name;
  Octree octree;
  glm::vec3 colour{0.93f, 0.89f, 0.80f};  ///< sRGB, 0..1
  std::optional<GreyOctree> grey{};
  double threshold = 0.0;
};

}  // namespace octotomy::voxel
