// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/camera.h"
#include "voxel/octree.h"
#include "voxel/ray_walk.h"

namespace octotomy::voxel {

/// The parallel rays of a picture through one octree, a square of pixels at a time: the octree is walked once
/// for all of them, front to back (thesis 4.4, theorem 4.1), and what lies behind rays that are done is never
/// looked into. Rays of a picture differ in a leaf only by where they pass it, so the voxels that they pass
/// there are tabulated, 64 to a word. What is found is what Walk (ray_walk.h) finds ray by ray.
/// Any number of threads may cast.
class ParallelRays {
 public:
  static constexpr int square_px = 64;  ///< edge of a square

  /// Takes a voxel of the octree that a pixel's ray passes; false to be offered the next one on its way.
  using Accept = std::function<bool(const glm::ivec2& pixel, const Passage& passage)>;

  /// Is told of a leaf's first voxel a little before its voxels are offered, to fetch what accepting them
  /// takes.
  using Announce = std::function<void(const glm::ivec3& leaf)>;

  /// Precondition: rays of an orthographic plane of the octree's universe. Keeps the octree.
  ParallelRays(const Octree& octree, const VoxelRays& rays);
  /// The same rays through another octree of the same universe.
  ParallelRays through(const Octree& octree) const;

  /// Offers what the rays of a square of pixels pass to `accept`, each ray its voxels from front to back.
  /// Pixels `first_px` to `last_px`, both included and at most square_px apart.
  /// Cost: the blocks of the octree that are not hidden, and one offer a ray and voxel.
  void cast(const glm::ivec2& first_px, const glm::ivec2& last_px, const Accept& accept,
            const Announce& announce = {}) const;

 private:
  static constexpr int cells = 32;  ///< of the table along each axis
  class Square;

  void tabulate();

  Octree octree_;
  VoxelRays rays_;
  Mirror mirror_;
  glm::dmat3x2 px_from_mirrored_{1.0};  ///< of directions
  std::array<glm::vec2, 64> places_;    ///< of a block's children from its centre, a child's edge being 1
  glm::vec2 half_px_{0.0f};             ///< half the extent of a block of edge 1
  float rounding_px_ = 0.0f;            ///< that blocks' positions may be off by
  std::vector<std::uint64_t> passed_;   ///< voxels that rays through a cell pass, by cell of a leaf's extent
};

}  // namespace octotomy::voxel
