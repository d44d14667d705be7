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

/// 2^depth voxels of 1 mm a side, their middle at the patient frame's origin.
inline voxel::Universe universe_about_origin(int depth) {
  const double half_mm = 0.5 * (1 << depth);
  return voxel::universe_around({glm::dvec3(-half_mm), glm::dvec3(half_mm)}, 1.0);
}

}  // namespace octotomy::tests
