// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::tests {

/// 2^depth voxels of a spacing along LPS, the centre of the first at `first_mm`: off the origin unless said,
/// so that a place in voxels never passes for one in millimetres.
inline voxel::Universe spaced_universe(int depth, const glm::dvec3& spacing_mm = glm::dvec3(1.0),
                                       const glm::dvec3& first_mm = {-7.5, 3.0, 11.0}) {
  return {depth, voxel::axis_aligned_lattice(glm::ivec3(1 << depth), spacing_mm, first_mm).lps_from_voxel};
}

}  // namespace octotomy::tests
