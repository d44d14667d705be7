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

/// Finds the surface of an object at voxels that rays pass. Keeps the object's samples; any number of threads
/// may ask.
class GreySurface {
 public:
  /// Precondition: the object has its samples.
  explicit GreySurface(const Drawn& object);

  /// Where trilinear samples cross the threshold (thesis 5.2.2.2), or the voxel's face where the object was
  /// cut there; none where the ray stays outside the surface. Precondition: the mirror is that of the ray.
  std::optional<Seen> seen(const VoxelRay& ray, const Mirror& mirror, const Passage& passage) const;
  /// The same of a moved object: its voxels do not lie on the samples, so that the surface is sought from two
  /// voxels before the one passed to its far side. Precondition: Drawn::moved_from_still is set.
  std::optional<Seen> seen_moved(const VoxelRay& ray, const Passage& passage) const;

 private:
  std::optional<Seen> seen_still(const VoxelRay& ray, const Mirror& mirror, const Passage& passage) const;

  GreyOctree grey_;
  float threshold_ = 0.0f;
  int side_ = 0;                                ///< of the object's universe
  std::optional<glm::dmat4> still_from_voxel_;  ///< Drawn::still_from_voxel()
};

}  // namespace octotomy::voxel
