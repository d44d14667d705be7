// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Frees the memory of a scene's samples. If a caller that is compiled without optimisation cleared the
/// samples itself, their destruction would visit every sample.
void drop_samples(Scene& scene);

}  // namespace octotomy::voxel
