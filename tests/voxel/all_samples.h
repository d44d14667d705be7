// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/grey_owner.h"

namespace octotomy::tests {

/// All samples of a grey octree, where they lie.
inline voxel::GreyOwners all_samples(const voxel::GreyOctree& grey) {
  const voxel::Window all{grey, -32768.0, 32767.0};
  return {grey.universe(), {voxel::SampleSource{voxel::Expression(all)}}};
}

}  // namespace octotomy::tests
