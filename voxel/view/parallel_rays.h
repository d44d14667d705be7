// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/tree/octree.h"
#include "voxel/view/camera.h"
#include "voxel/view/ray_batch.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// The parallel rays of a picture through one octree, a square of pixels at a time. One walk of the octree,
/// front to back (thesis 4.4, theorem 4.1), serves all rays of the square, and skips nodes behind rays that
/// have ended. Within a leaf, rays differ only by their position, so a table holds the voxels that a ray may
/// pass, 64 to a word. Rays that meet the same leaf are processed together, as vectors. The result for each
/// ray equals that of Walk (ray_walk.h). Any number of threads may call cast().
class ParallelRays {
 public:
  static constexpr int square_px = 64;  ///< edge of a square

  /// Receives voxels of the octree that rays pass. Returns the rays that end there.
  using Accept = std::function<RayBatch::Rays(const RayBatch& batch)>;

  /// Receives the first voxel of a leaf some time before the leaf's voxels are passed to Accept, so that data
  /// can be prefetched.
  using Announce = std::function<void(const glm::ivec3& leaf)>;

  /// Precondition: the rays belong to an orthographic plane of the octree's universe. Shares the octree's
  /// nodes.
  ParallelRays(const Octree& octree, const VoxelRays& rays);
  /// The same rays through another octree of the same universe.
  ParallelRays through(const Octree& octree) const;

  /// Calls `accept` with the voxels that the rays of a square of pixels pass, each ray's from front to back.
  /// The square is pixels `first_px` to `last_px`, both included. Precondition: the square has at most
  /// square_px pixels a side. Cost: grows with the visible blocks of the octree, and one call for up to 64
  /// rays that pass a leaf.
  void cast(const glm::ivec2& first_px, const glm::ivec2& last_px, const Accept& accept,
            const Announce& announce = {}) const;

 private:
  static constexpr int cells = 32;  ///< number of the table's cells along each axis
  class Square;

  void tabulate();

  Octree octree_;
  VoxelRays rays_;
  Mirror mirror_;
  glm::dmat3x2 px_from_mirrored_{1.0};  ///< of directions
  /// Centres of a block's children relative to the block's centre in the picture, for children of edge 1.
  std::array<glm::vec2, 64> places_;
  glm::vec2 half_px_{0.0f};   ///< half the extent of a block of edge 1
  float rounding_px_ = 0.0f;  ///< upper bound of the error of blocks' positions
  /// For each cell of a leaf's extent in the picture, the voxels that rays in the cell may pass.
  std::vector<std::uint64_t> passed_;
};

}  // namespace octotomy::voxel
