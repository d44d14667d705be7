// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// For each voxel of a lattice, the share that an octree's voxels fill. Exact to double precision, so the
/// shares times a voxel's volume add up to the octree's volume within the lattice. None unless the axes of
/// octree and lattice are parallel, in any order and direction. Throws Stopped. Cost: the octree's planes.
/// Memory: eight bytes a sample.
std::optional<std::vector<double>> occupancy(const Octree& octree, const Lattice& lattice,
                                             const Progress& progress = {});

}  // namespace octotomy::voxel
