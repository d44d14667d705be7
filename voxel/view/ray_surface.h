// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "voxel/view/depth_image.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// A ray in index space: its point at depth 0 and its step per millimetre of depth.
struct VoxelRay {
  glm::dvec3 start{0.0};
  glm::dvec3 per_mm{0.0};
};

/// Computes the surface of an object near voxels that rays pass. Shares the object's samples. Any number of
/// threads may call it.
class GreySurface {
 public:
  /// Precondition: the object has samples.
  explicit GreySurface(const DrawnObject& object);

  /// The crossing of the threshold by trilinear samples (thesis 5.2.2.2), or the voxel's face if the object
  /// was cut there; none if the ray remains outside the surface. Precondition: the mirror is that of the ray.
  std::optional<Seen> seen(const VoxelRay& ray, const Mirror& mirror, const Passage& passage) const;
  /// The surface of a moved object, whose voxels do not lie on the samples. Searches from two voxels in front
  /// of the passed voxel to this voxel's far side. Precondition: DrawnObject::moved_from_still is set.
  std::optional<Seen> seen_moved(const VoxelRay& ray, const Passage& passage) const;

 private:
  std::optional<Seen> seen_still(const VoxelRay& ray, const Mirror& mirror, const Passage& passage) const;

  GreyOctree grey_;
  float threshold_ = 0.0f;
  int side_ = 0;                                ///< of the object's universe
  std::optional<glm::dmat4> still_from_voxel_;  ///< DrawnObject::still_from_voxel()
};

}  // namespace octotomy::voxel
