// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_batch.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>

#include "voxel/space/vector_clones.h"

// Vectors are passed only between functions of this file, which are all inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace octotomy::voxel {
namespace {

constexpr int lanes = 4;
using Double = double __attribute__((vector_size(8 * lanes)));
using Long = std::int64_t __attribute__((vector_size(8 * lanes)));
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

/// The coordinates of rays and voxels along one axis.
struct Axis {
  double first, per_px_x, per_px_y;  ///< step of the rays per millimetre of depth, in index space
  double side, leaf, mm_per_voxel;   ///< mirrored
  bool flipped, still;
};

/// Computes the passages of a batch's rays through their voxels, beginning with the first ray of a vector.
/// The voxel of ray i is the leaf's voxel number voxels[i]. Returns the rays that pass their voxels; bits
/// beyond the batch are meaningless.
OCTOTOMY_VECTOR_CLONES RayBatch::Rays pass(const Axis* axes, const std::int32_t* voxels, int first,
                                           RayBatch& batch) {
  const Long ray{1, 2, 4, 8};
  Long passing{};
  for (int from = first; from < batch.count; from += lanes) {
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
    const Long meets = (enter_mm < leave_mm) & (misses == 0.0);
    passing |= meets & (ray << from);
    store(meets ? enter_mm : Double{}, batch.enter_mm.data() + from);
    store(meets ? leave_mm : Double{}, batch.leave_mm.data() + from);
    store(__builtin_convertvector(through, Int), batch.entered_through.data() + from);
  }
  return static_cast<RayBatch::Rays>((passing[0] | passing[1]) | (passing[2] | passing[3]));
}

}  // namespace

RayBatch::Rays find_passages(const VoxelRays& rays, const Mirror& mirror,
                             const RayBatch::ByRay<std::uint64_t>& voxels, int first, RayBatch& batch) {
  assert(0 <= first && first < batch.count);
  Axis axes[3];
  for (int axis = 0; axis < 3; ++axis)
    axes[axis] = {rays.first[axis],          rays.per_px_x[axis],      rays.per_px_y[axis],
                  double(mirror.side),       double(batch.leaf[axis]), mirror.mm_per_voxel[axis],
                  mirror.flipped[axis] != 0, mirror.still[axis]};
  // Rays before `first` in the same vector are computed again, with the same result.
  const int aligned = first - first % lanes;
  RayBatch::ByRay<std::int32_t> numbers;
  for (int ray = aligned; ray < batch.count; ++ray)
    numbers[static_cast<std::size_t>(ray)] = std::countr_zero(voxels[static_cast<std::size_t>(ray)]);
  // Unused rays of the last vector must have a valid voxel number.
  std::fill_n(numbers.begin() + batch.count, std::min(lanes, RayBatch::most - batch.count), 0);
  return pass(axes, numbers.data(), aligned, batch) & RayBatch::all(batch.count) & RayBatch::from(first);
}

}  // namespace octotomy::voxel
