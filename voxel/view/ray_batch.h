// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "voxel/view/camera.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// Parallel rays, each with one voxel of the same leaf. Entry i of every array belongs to ray i, so that the
/// compiler can vectorise loops over rays.
struct RayBatch {
  static constexpr int most = 64;
  template <typename Value>
  using ByRay = std::array<Value, most>;

  glm::ivec3 leaf{0};  ///< the leaf's first voxel, mirrored (ray_walk.h)
  int count = 0;
  ByRay<std::int32_t> x{}, y{};             ///< pixels
  std::array<ByRay<double>, 3> start{};     ///< for each axis the ray's point at depth 0, in index space
  std::array<ByRay<std::int32_t>, 3> at{};  ///< for each axis the voxel's position in the leaf, mirrored
  /// Depths at which the ray enters and leaves the voxel; 0 if it does not pass the voxel.
  ByRay<double> enter_mm{}, leave_mm{};
  ByRay<std::int32_t> entered_through{};  ///< axis

  Passage passage(std::size_t ray) const {
    return {leaf + glm::ivec3(at[0][ray], at[1][ray], at[2][ray]), enter_mm[ray], leave_mm[ray],
            entered_through[ray]};
  }

  /// A set of rays: bit i is set if ray i is in the set.
  using Rays = std::uint64_t;
  /// The set of the first `count` rays. Precondition: `count` is at least 1.
  static Rays all(int count) { return ~Rays{0} >> (most - count); }
  /// The set of all rays from number `first` on. Precondition: `first` is below `most`.
  static Rays from(int first) { return ~Rays{0} << first; }

  /// Copies ray `ray` and its passage over ray `place`.
  void put(std::size_t ray, std::size_t place) {
    for (auto* by_ray : {&x, &y, &at[0], &at[1], &at[2], &entered_through}) (*by_ray)[place] = (*by_ray)[ray];
    for (auto* by_ray : {&start[0], &start[1], &start[2], &enter_mm, &leave_mm})
      (*by_ray)[place] = (*by_ray)[ray];
  }
};

/// For each ray of a batch from number `first` on, computes its passage through the lowest-numbered voxel set
/// in `voxels` (one bit for each voxel of the leaf), with the same bits as passage_of(). Returns the rays
/// that pass their voxels. Precondition: `first` is a ray of the batch.
RayBatch::Rays find_passages(const VoxelRays& rays, const Mirror& mirror,
                             const RayBatch::ByRay<std::uint64_t>& voxels, int first, RayBatch& batch);

}  // namespace octotomy::voxel
