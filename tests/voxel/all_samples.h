// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/grey_owner.h"

namespace octotomy::tests {

/// The expression part that owns all samples of a grey octree at their positions.
inline voxel::GreyOwners all_samples(const voxel::GreyOctree& grey) {
  const voxel::Window all{grey, -32768.0, 32767.0};
  return {grey.universe(), {voxel::SampleSource{voxel::Expression(all)}}};
}

}  // namespace octotomy::tests
