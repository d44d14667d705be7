// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The share of each of a lattice's voxels that an octree's voxels fill, exact but for double precision, so
/// that shares times the voxels' volume add up to the octree's volume within the lattice. None unless the axes
/// of octree and lattice are parallel, in any order and direction. Throws Stopped. Cost: the octree's planes.
/// Memory: eight bytes a sample.
std::optional<std::vector<double>> occupancy(const Octree& octree, const Lattice& lattice,
                                             const Progress& progress = {});

}  // namespace octotomy::voxel
