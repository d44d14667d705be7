// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/tree/octree.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

/// Which slices of the universe hold a voxel of the object: one entry a slice. Cost: one walk of the nodes.
std::vector<bool> occupied_slices(const Octree& octree);

/// Calls `visit` for every slice that holds a voxel, in ascending z. Cost: the universe's slice, side^2 / 8
/// bytes, once for every such slice; that much memory.
void for_each_slice(const Octree& octree, const std::function<void(int z, const SliceBits& slice)>& visit);

/// The octree of a universe's slices. `draw` is called once a slice in ascending z with an empty slice of the
/// universe's side to set bits in, and says whether it set any.
/// Memory: 17 slices of side^2 / 8 bytes, and the octree's.
Octree octree_of_slices(const Universe& universe, const std::function<bool(int z, SliceBits& slice)>& draw);

/// Sets the voxels first..last of a row. Precondition: within the slice.
void set_row(SliceBits& slice, int y, int first, int last);

/// The runs of voxels of a row in ascending order: the first from `from` on. False if there is none.
/// Precondition: from <= side.
bool next_run(const SliceBits& slice, int y, int from, int& first, int& last);

}  // namespace octotomy::voxel
