// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/tree/octree.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

/// For each slice of the universe, whether it contains a voxel of the object. Cost: one walk of the nodes.
std::vector<bool> occupied_slices(const Octree& octree);

/// Calls `visit` for every slice that contains a voxel, in ascending z. Cost: writes side^2 / 8 bytes for
/// each such slice. Memory: one slice.
void for_each_slice(const Octree& octree, const std::function<void(int z, const SliceBits& slice)>& visit);

/// The octree of a universe's slices. `draw` is called once per slice in ascending z. It receives an empty
/// slice of the universe's side, sets bits in the slice and returns whether it set any. Memory: 17 slices of
/// side^2 / 8 bytes, and the octree.
Octree octree_of_slices(const Universe& universe, const std::function<bool(int z, SliceBits& slice)>& draw);

/// Sets the voxels first..last of a row, both included. Precondition: they lie within the slice.
void set_row(SliceBits& slice, int y, int first, int last);

/// Searches a row for the first run of set voxels at or after voxel `from`, and stores the run's first and
/// last voxel. Returns false if there is none. Precondition: from <= side.
bool next_run(const SliceBits& slice, int y, int from, int& first, int& last);

}  // namespace octotomy::voxel
