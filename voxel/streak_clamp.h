// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/progress.h"
#include "voxel/scene.h"

namespace octotomy::voxel {

struct StreakOptions {
  double metal = 3000.0;    ///< samples from here on are metal, in the scene's units (HU)
  double low = -1000.0;     ///< what is less becomes this: dark streaks fall below air
  double high = 3000.0;     ///< what is more becomes this: metal and the brightest streaks
  double reach_mm = 100.0;  ///< from metal, within its slice: streaks run in the plane of the X-rays' turn
  Progress progress{};
};

/// What a clamp did.
struct StreakClamp {
  Scene scene;
  std::uint64_t metal = 0;    ///< samples
  std::uint64_t raised = 0;   ///< samples that were below `low`
  std::uint64_t lowered = 0;  ///< samples that were above `high`
  int slices = 0;             ///< that hold metal
};
/// Limits samples near metal, slice by slice (index z), to what tissue can have, so that streaks neither
/// stretch windows nor pull interpolated surfaces. A clamp, not a correction: streaks between the bounds
/// stay. Throws std::invalid_argument where low is not below high, a number is not finite, the reach
/// negative, or the first two axes are not perpendicular; Stopped. Parallel over slices. Memory: the result.
StreakClamp clamp_streaks(const Scene& scene, const StreakOptions& options);

}  // namespace octotomy::voxel
