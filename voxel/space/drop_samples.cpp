// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/drop_samples.h"

namespace octotomy::voxel {

void drop_samples(Scene& scene) {
  scene.samples = {};
}

}  // namespace octotomy::voxel
