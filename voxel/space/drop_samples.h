// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Frees the memory of a scene's samples. Clearing them does the same, but in callers that are compiled
/// without optimisation the destruction then visits every sample.
void drop_samples(Scene& scene);

}  // namespace octotomy::voxel
