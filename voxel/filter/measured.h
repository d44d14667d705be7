// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>

#include "voxel/space/scene.h"

// Filters of scans in which the scanner measured only a part.
namespace octotomy::voxel {

/// The result of a filter that keeps the lattice, on a scene with padding. The filter reads each padded
/// sample as the nearest measured one of its slice, as the border repeats beyond a scene's faces; a slice
/// without any repeats the nearest slice that has some, the lower one of two. The result is padded where the
/// scene is, and its padding is below all that the filter made. Without padding the filter takes the scene
/// itself. `filter` never sees a scene with padding. Parallel over slices, same bits on any thread count.
/// Memory: a copy of the samples.
Scene on_measured(const Scene& scene, const std::function<Scene(const Scene&)>& filter);

}  // namespace octotomy::voxel
