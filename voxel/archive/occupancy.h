// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// For each voxel of a lattice, x fastest, the share 0..1 that an octree's voxels fill. The shares are exact
/// to double precision: their sum times a lattice voxel's volume is the octree's volume within the lattice.
/// None unless the axes of octree and lattice are parallel, in any order and direction. Throws Stopped. Cost:
/// one pass over the octree's voxels. Memory: eight bytes for each voxel of the lattice.
std::optional<std::vector<double>> occupancy(const Octree& octree, const Lattice& lattice,
                                             const Progress& progress = {});

}  // namespace octotomy::voxel
