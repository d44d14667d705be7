// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "voxel/view/camera.h"
#include "voxel/view/ray_walk.h"

namespace octotomy::voxel {

/// Parallel rays that pass voxels of one leaf, each its own. A number of an array is a ray's, so that loops
/// over rays become vectors.
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

  /// Bit i of a set of rays stands for ray i.
  using Rays = std::uint64_t;
  /// The rays of a batch of `count`. Precondition: at least one.
  static Rays all(int count) { return ~Rays{0} >> (most - count); }
  /// The rays from number `first` on. Precondition: less than `most`.
  static Rays from(int first) { return ~Rays{0} << first; }

  /// Puts one ray and its passage in the place of another.
  void put(std::size_t ray, std::size_t place) {
    for (auto* by_ray : {&x, &y, &at[0], &at[1], &at[2], &entered_through}) (*by_ray)[place] = (*by_ray)[ray];
    for (auto* by_ray : {&start[0], &start[1], &start[2], &enter_mm, &leave_mm})
      (*by_ray)[place] = (*by_ray)[ray];
  }
};

/// Finds the passages of a batch's rays, those from number `first` on, through the first of the voxels of the
/// leaf that each may pass, one bit a voxel, bit for bit as passage_of(). Returns those of them that do pass
/// it. Precondition: `first` is a ray of the batch.
RayBatch::Rays find_passages(const VoxelRays& rays, const Mirror& mirror,
                             const RayBatch::ByRay<std::uint64_t>& voxels, int first, RayBatch& batch);

}  // namespace octotomy::voxel
