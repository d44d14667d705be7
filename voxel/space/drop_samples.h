// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Gives the memory of a scene's samples back. Emptying them does the same, but a caller that is compiled
/// with little optimisation then visits each sample to destroy it.
void drop_samples(Scene& scene);

}  // namespace octotomy::voxel
