// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::tests {

/// 2^depth voxels of 1 mm a side; index space is LPS.
inline voxel::Universe unit_universe(int depth) {
  voxel::Universe universe;
  universe.depth = depth;
  return universe;
}

/// 64 voxels of 1 mm a side about the origin.
inline voxel::Universe universe_of_64() {
  return voxel::universe_around({glm::dvec3(-32.0), glm::dvec3(32.0)}, 1.0);
}

}  // namespace octotomy::tests
