// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "voxel/depth_image.h"
#include "voxel/drawn.h"
#include "voxel/ray_walk.h"

namespace octotomy::voxel {

/// A ray in index space, where it is at depth 0 and what it moves by a millimetre of depth.
struct VoxelRay {
  glm::dvec3 start{0.0};
  glm::dvec3 per_mm{0.0};
};

/// The surface of a grey object at a voxel that a ray passes: where trilinear samples cross the threshold
/// (thesis 5.2.2.2), or the voxel's face where the object was cut there; none where the ray stays outside the
/// surface. Precondition: the object has its samples; the mirror is that of the ray.
std::optional<Seen> grey_surface(const Drawn& object, const VoxelRay& ray, const Mirror& mirror,
                                 const Passage& passage);

}  // namespace octotomy::voxel
