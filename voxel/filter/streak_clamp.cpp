// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/streak_clamp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "voxel/filter/slice_work.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

struct SliceCounts {
  std::uint64_t metal = 0, raised = 0, lowered = 0;
};

template <typename Sample>
SliceCounts clamp_slice(Sample* slice, const Lattice& lattice, std::optional<double> padding,
                        const StreakOptions& options) {
  const glm::ivec3 dims(lattice.dims.x, lattice.dims.y, 1);
  DistanceMap map{{glm::ivec3(0), dims - 1}, {}};
  map.square_mm2.assign(static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y),
                        std::numeric_limits<float>::infinity());
  SliceCounts counts;
  for (std::size_t at = 0; at < map.square_mm2.size(); ++at)
    if (static_cast<double>(slice[at]) >= options.metal) {
      map.square_mm2[at] = 0.0F;
      ++counts.metal;
    }
  if (counts.metal == 0) return counts;
  spread(map, Universe{2, lattice.lps_from_voxel});
  const double most_mm2 = options.reach_mm * options.reach_mm;
  for (std::size_t at = 0; at < map.square_mm2.size(); ++at) {
    if (static_cast<double>(map.square_mm2[at]) > most_mm2) continue;
    const auto sample = static_cast<double>(slice[at]);
    if (sample == padding) continue;
    if (sample < options.low) {
      slice[at] = static_cast<Sample>(options.low);
      ++counts.raised;
    } else if (sample > options.high) {
      slice[at] = static_cast<Sample>(options.high);
      ++counts.lowered;
    }
  }
  return counts;
}

}  // namespace

StreakClamp clamp_streaks(const Scene& scene, const StreakOptions& options) {
  check(scene);
  if (!(options.low < options.high) || !std::isfinite(options.low) || !std::isfinite(options.high) ||
      !std::isfinite(options.metal) || !(options.reach_mm >= 0.0) || !std::isfinite(options.reach_mm))
    throw InvalidInput(
        "to clamp streaks, all numbers must be finite, low must be below high, and the reach at least 0 mm");
  StreakClamp result{scene};
  const int slices = scene.lattice.dims.z;
  std::vector<SliceCounts> counts(static_cast<std::size_t>(slices));
  const std::size_t size = slice_size(scene.lattice);
  std::visit(
      [&](auto& samples) {
        for_each_slice(slices, options.progress, [&](int k) {
          counts[static_cast<std::size_t>(k)] = clamp_slice(
              samples.data() + static_cast<std::size_t>(k) * size, scene.lattice, scene.padding, options);
        });
      },
      result.scene.samples);
  for (const SliceCounts& slice : counts) {
    result.metal += slice.metal;
    result.raised += slice.raised;
    result.lowered += slice.lowered;
    result.slices += slice.metal > 0 ? 1 : 0;
  }
  return result;
}

}  // namespace octotomy::voxel
