// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

struct StreakOptions {
  double metal = 3000.0;  ///< samples of at least this value are metal, in the scene's units (HU)
  double low = -1000.0;   ///< lower samples are raised to this value, because dark streaks are below air
  double high = 3000.0;   ///< higher samples, of metal and the brightest streaks, are lowered to this value
  /// Samples up to this distance from metal in the same slice are clamped, because streaks lie in the plane
  /// of the X-rays.
  double reach_mm = 100.0;
  Progress progress{};
};

/// The clamped scene and its statistics.
struct StreakClamp {
  Scene scene;
  std::uint64_t metal = 0;    ///< samples
  std::uint64_t raised = 0;   ///< number of samples that were below `low`
  std::uint64_t lowered = 0;  ///< number of samples that were above `high`
  int slices = 0;             ///< slices that hold metal
};
/// Clamps samples near metal, slice by slice (index z), to the range of tissue, so that streaks neither
/// stretch windows nor shift interpolated surfaces. Streaks between the bounds and padding do not change.
/// Throws std::invalid_argument if low is not below high, a number is not finite, the reach is negative, or
/// the first two axes are not perpendicular; Stopped. Parallel over slices. Memory: the result.
StreakClamp clamp_streaks(const Scene& scene, const StreakOptions& options);

}  // namespace octotomy::voxel
