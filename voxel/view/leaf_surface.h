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

/// Computes an object's surface near the voxels of a leaf that parallel rays pass, for many rays at once.
/// Each result has the same bits as that of GreySurface::seen(). Caches the samples around the last leaf. To
/// be used by one thread at a time.
class LeafSurface {
 public:
  /// For rays of `per_mm` voxels per millimetre of depth. Preconditions: the object has samples; the mirror
  /// is that of the rays. The object's samples and the mirror must outlive this object.
  LeafSurface(const DrawnObject& object, const glm::dvec3& per_mm, const Mirror& mirror);

  /// The surfaces that the rays of a batch meet.
  struct Found {
    RayBatch::Rays lit = 0;      ///< the rays that meet a surface
    RayBatch::Rays stepped = 0;  ///< the lit rays whose surface is the voxel's face
    RayBatch::ByRay<float> depth_mm;
  };
  /// Computes the surface of every ray in the batch. Precondition: all of them pass their voxels. For a moved
  /// object, only the rays' starts and the depths of their voxels are used, and the voxels need not be of one
  /// leaf.
  void find(const RayBatch& batch, Found& found);

  /// The number of samples, along each axis, on which the surface in a leaf may depend: from three voxels in
  /// front of the leaf to one behind, because a surface is searched for up to two voxels in front of a voxel
  /// (ray_surface.cpp).
  static constexpr int side = 8;

 private:
  void go_to(const glm::ivec3& leaf);

  const GreyOctree& grey_;
  const Mirror& mirror_;
  std::optional<glm::dmat4> still_from_voxel_;  ///< DrawnObject::still_from_voxel()
  /// Step of the rays per millimetre of depth, in voxels of the samples.
  glm::dvec3 per_mm_;
  float half_voxel_mm_;  ///< depth that half a voxel's length along a ray spans
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
