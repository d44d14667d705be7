// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "voxel/view/camera.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// Parallel rays, each with one voxel of the same leaf. Entry i of every array belongs to ray i, so that
/// loops over rays become vectors.
struct RayBatch {
  static constexpr int most = 64;
  template <typename Value>
  using ByRay = std::array<Value, most>;

  glm::ivec3 leaf{0};  ///< its first voxel, mirrored (ray_walk.h)
  int count = 0;
  ByRay<std::int32_t> x{}, y{};             ///< pixels
  std::array<ByRay<double>, 3> start{};     ///< by axis: the ray's point at depth 0 in index space
  std::array<ByRay<std::int32_t>, 3> at{};  ///< by axis: the voxel's place in the leaf, mirrored
  ByRay<double> enter_mm{}, leave_mm{};     ///< depths of the voxel; 0 if the ray does not pass it
  ByRay<std::int32_t> entered_through{};    ///< axis

  Passage passage(std::size_t ray) const {
    return {leaf + glm::ivec3(at[0][ray], at[1][ray], at[2][ray]), enter_mm[ray], leave_mm[ray],
            entered_through[ray]};
  }

  /// A set of rays: bit i is set if ray i is in the set.
  using Rays = std::uint64_t;
  /// The rays of a batch of `count`. Precondition: at least one.
  static Rays all(int count) { return ~Rays{0} >> (most - count); }
  /// The rays from number `first` on. Precondition: less than `most`.
  static Rays from(int first) { return ~Rays{0} << first; }

  /// Copies ray `ray` and its passage over ray `place`.
  void put(std::size_t ray, std::size_t place) {
    for (auto* by_ray : {&x, &y, &at[0], &at[1], &at[2], &entered_through}) (*by_ray)[place] = (*by_ray)[ray];
    for (auto* by_ray : {&start[0], &start[1], &start[2], &enter_mm, &leave_mm})
      (*by_ray)[place] = (*by_ray)[ray];
  }
};

/// For each ray of a batch from number `first` on, computes its passage through the lowest-numbered voxel set
/// in `voxels` (one bit a voxel of the leaf), bit for bit as passage_of() does. Returns the rays that do pass
/// their voxel. Precondition: `first` is a ray of the batch.
RayBatch::Rays find_passages(const VoxelRays& rays, const Mirror& mirror,
                             const RayBatch::ByRay<std::uint64_t>& voxels, int first, RayBatch& batch);

}  // namespace octotomy::voxel
