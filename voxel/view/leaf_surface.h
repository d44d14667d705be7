// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include "voxel/view/drawn_object.h"
#include "voxel/view/ray_batch.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// Finds an object's surface near the voxels of a leaf that parallel rays pass, for many rays at once: the
/// result for each is bit for bit that of GreySurface::seen(). Keeps the samples about the last leaf. For one
/// thread.
class LeafSurface {
 public:
  /// For rays of `per_mm` voxels per millimetre of depth. Preconditions: the object has its samples; the
  /// mirror is that of the rays. Refers to the object's samples and the mirror.
  LeafSurface(const DrawnObject& object, const glm::dvec3& per_mm, const Mirror& mirror);

  /// What the rays of a batch see.
  struct Found {
    RayBatch::Rays lit = 0;      ///< the rays that meet the surface
    RayBatch::Rays stepped = 0;  ///< the lit rays whose surface is the voxel's face
    RayBatch::ByRay<float> depth_mm;
  };
  /// Finds the surface of every ray in the batch. Precondition: all of them pass their voxels. For a moved
  /// object, only the rays' starts and the depths of their voxels are used, and the voxels need not be of one
  /// leaf.
  void find(const RayBatch& batch, Found& found);

  /// Samples that the surface in a leaf may depend on: from three voxels in front of the leaf to one behind,
  /// because a surface is sought up to two voxels in front of a voxel (ray_surface.cpp).
  static constexpr int side = 8;

 private:
  void go_to(const glm::ivec3& leaf);

  const GreyOctree& grey_;
  const Mirror& mirror_;
  std::optional<glm::dmat4> still_from_voxel_;  ///< DrawnObject::still_from_voxel()
  glm::dvec3 per_mm_;                           ///< of the rays, in voxels of the samples
  float half_voxel_mm_;                         ///< along a ray, in depth
  float threshold_;
  int universe_side_;
  glm::ivec3 leaf_{std::numeric_limits<int>::min()};
  glm::ivec3 native_{0};              ///< the leaf's first voxel
  glm::ivec3 first_{0};               ///< the voxel of the first sample
  glm::ivec3 from_{0}, until_{side};  ///< the samples that these rays need, counted from `first_`
  /// Entry x + 8y + 64z, counted from `first_`: the four samples at (x, y, z), (x + 1, y, z), (x, y + 1, z)
  /// and (x + 1, y + 1, z), 16 bits each, lowest first.
  alignas(64) std::array<std::uint64_t, side * side * side> fours_;
};

}  // namespace octotomy::voxel
