// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_batch.h"

#include <bit>
#include <cstring>
#include <limits>

#include "voxel/space/vector_clones.h"

// Vectors are passed between functions of this file alone, all of them inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace octotomy::voxel {
namespace {

constexpr int lanes = 4;
using Double = double __attribute__((vector_size(8 * lanes)));
using Int = std::int32_t __attribute__((vector_size(4 * lanes)));

[[gnu::always_inline]] inline Int load(const std::int32_t* from) {
  Int vector;
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}
[[gnu::always_inline]] inline Double doubles(const Int& vector) {
  return __builtin_convertvector(vector, Double);
}
[[gnu::always_inline]] inline void store(const Double& vector, double* to) {
  std::memcpy(to, &vector, sizeof vector);
}
[[gnu::always_inline]] inline void store(const Int& vector, std::int32_t* to) {
  std::memcpy(to, &vector, sizeof vector);
}

/// Rays and voxels along one axis.
struct Axis {
  double first, per_px_x, per_px_y;  ///< of the rays, in index space
  double side, leaf, mm_per_voxel;   ///< mirrored
  bool flipped, still;
};

/// The passages of a batch's rays through the voxels of the leaf with the given numbers.
OCTOTOMY_VECTOR_CLONES void pass(const Axis* axes, const std::int32_t* voxels, RayBatch& batch,
                                 std::int32_t* passes) {
  for (int from = 0; from < batch.count; from += lanes) {
    const Double across = doubles(load(batch.x.data() + from)) + 0.5;
    const Double down = doubles(load(batch.y.data() + from)) + 0.5;
    const Int voxel = load(voxels + from);
    const Int place[3] = {voxel & 3, (voxel >> 2) & 3, voxel >> 4};
    Double enter_mm = Double{} - std::numeric_limits<double>::infinity();
    Double leave_mm = Double{} + std::numeric_limits<double>::infinity();
    Double through{};
    Double misses{};
    for (int number = 0; number < 3; ++number) {
      const Axis& axis = axes[number];
      store(place[number], batch.at[static_cast<std::size_t>(number)].data() + from);
      const Double start = axis.first + across * axis.per_px_x + down * axis.per_px_y;
      store(start, batch.start[static_cast<std::size_t>(number)].data() + from);
      const Double p = axis.flipped ? axis.side - (start + 0.5) : start + 0.5;
      const Double at = axis.leaf + doubles(place[number]);
      if (axis.still) {
        misses = ((p < at) | (p >= at + 1.0)) ? Double{} + 1.0 : misses;
        continue;
      }
      const Double enter = (at - p) * axis.mm_per_voxel;
      const Double leave = enter + axis.mm_per_voxel;
      through = enter > enter_mm ? Double{} + double(number) : through;
      enter_mm = enter > enter_mm ? enter : enter_mm;
      leave_mm = leave < leave_mm ? leave : leave_mm;
    }
    const auto meets = (enter_mm < leave_mm) & (misses == 0.0);
    store(meets ? enter_mm : Double{}, batch.enter_mm.data() + from);
    store(meets ? leave_mm : Double{}, batch.leave_mm.data() + from);
    store(__builtin_convertvector(through, Int), batch.entered_through.data() + from);
    store(__builtin_convertvector(meets ? Double{} + 1.0 : Double{}, Int), passes + from);
  }
}

}  // namespace

RayBatch::Rays find_passages(const VoxelRays& rays, const Mirror& mirror,
                             const RayBatch::ByRay<std::uint64_t>& voxels, RayBatch& batch) {
  Axis axes[3];
  for (int axis = 0; axis < 3; ++axis)
    axes[axis] = {rays.first[axis],          rays.per_px_x[axis],      rays.per_px_y[axis],
                  double(mirror.side),       double(batch.leaf[axis]), mirror.mm_per_voxel[axis],
                  mirror.flipped[axis] != 0, mirror.still[axis]};
  const auto count = static_cast<std::size_t>(batch.count);
  RayBatch::ByRay<std::int32_t> first{}, passes;
  for (std::size_t ray = 0; ray < count; ++ray) first[ray] = std::countr_zero(voxels[ray]);
  pass(axes, first.data(), batch, passes.data());
  RayBatch::Rays passing = 0;
  for (std::size_t ray = 0; ray < count; ++ray) passing |= static_cast<RayBatch::Rays>(passes[ray]) << ray;
  return passing;
}

}  // namespace octotomy::voxel
