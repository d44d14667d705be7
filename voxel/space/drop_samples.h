// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Gives the memory of a scene's samples back, as emptying them does, but at no cost for each sample: a
/// vector with an allocator of its own destroys its elements one by one, in a loop without effect that is
/// there wherever sources are optimised less than this one.
void drop_samples(Scene& scene);

}  // namespace octotomy::voxel
