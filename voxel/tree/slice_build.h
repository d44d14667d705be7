// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "voxel/tree/octree.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

/// For each slice of the universe, whether it contains a voxel of the object. Cost: one walk of the nodes.
std::vector<bool> occupied_slices(const Octree& octree);

/// Calls `visit` for every slice that contains a voxel, in ascending z. Cost: side^2 / 8 bytes written per
/// such slice. Memory: one slice.
void for_each_slice(const Octree& octree, const std::function<void(int z, const SliceBits& slice)>& visit);

/// The octree of a universe's slices. `draw` is called once per slice in ascending z. `draw` receives an
/// empty slice of the universe's side, sets bits in the slice and returns whether it set any. Memory: 17
/// slices of side^2 / 8 bytes, and the octree's.
Octree octree_of_slices(const Universe& universe, const std::function<bool(int z, SliceBits& slice)>& draw);

/// Sets the voxels first..last of a row. Precondition: within the slice.
void set_row(SliceBits& slice, int y, int first, int last);

/// Finds the first run of voxels of a row at or after voxel `from` and stores its ends, both included.
/// Returns false if there is none. Precondition: from <= side.
bool next_run(const SliceBits& slice, int y, int from, int& first, int& last);

}  // namespace octotomy::voxel
