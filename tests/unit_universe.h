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

}  // namespace octotomy::tests
