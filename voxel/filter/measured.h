// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>

#include "voxel/space/scene.h"

// Applies filters to scans that have padding.
namespace octotomy::voxel {

/// Applies a filter that keeps the lattice to a scene with padding. `filter` receives a copy without padding:
/// each padded sample is replaced by the nearest measured sample of its slice. A slice without measured
/// samples becomes a copy of the nearest slice with measured samples; of two equally near slices, the lower
/// one. The result is padded at the same samples as the scene, with a value below all samples that the filter
/// returned. A scene without padding is passed to the filter unchanged. Parallel over slices, same bits on
/// any thread count. Memory: a copy of the samples.
Scene on_measured(const Scene& scene, const std::function<Scene(const Scene&)>& filter);

}  // namespace octotomy::voxel
