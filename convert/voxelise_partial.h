// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/voxelise.h"
#include "voxel/partial_octree.h"

namespace octotomy::convert {

/// The share of every voxel that a closed mesh fills, exact but for rounding to 1 / 65535, and the voxels
/// that are wholly inside (D1) and touched (D2) by it. A voxel is a cuboid half an edge around its centre; a
/// surface that only brushes it from without does not touch it, and Inside of a solid is exactly what
/// Touching of its outside leaves, as voxel::digitise() has it for shapes. at_least_half() of the answer is
/// D4. The mesh may reach out of the universe. Precondition: no self-intersection; where it has any, shares
/// are cut off at nothing and the whole. Throws std::invalid_argument as voxelise(); voxel::Stopped. Parallel
/// over slabs; same bits on any thread count. Cost: the pieces into which voxels cut the triangles, each a
/// polygon; 24 bytes a piece in sixteen layers a thread.
voxel::PartialOctree voxelise_partial(const voxel::Universe& universe, const brep::Mesh& solid,
                                      const VoxeliseOptions& options = {});

}  // namespace octotomy::convert
