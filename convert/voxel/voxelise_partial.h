// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::convert {

/// The share of every voxel that a closed mesh fills, exact but for rounding to 1 / 65535, and the voxels
/// wholly inside (D1) and touched (D2) by it. A voxel is a cuboid half an edge around its centre. A surface
/// that only brushes a voxel from outside does not touch it: the voxels inside a solid are those that its
/// outside does not touch, as for voxel::digitise(). at_least_half() of the answer is D4. The mesh may reach
/// out of the universe. Precondition: no self-intersection; otherwise shares are clamped to 0 and 1. Throws
/// as voxelise(). Parallel over slabs; same bits on any thread count. Cost: the polygons into which voxels
/// cut the triangles; memory 24 bytes a polygon of the sixteen layers that each thread works on.
voxel::PartialOctree voxelise_partial(const voxel::Universe& universe, const brep::Linked& solid,
                                      const voxel::Progress& progress = {});

}  // namespace octotomy::convert
