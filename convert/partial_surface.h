// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "voxel/partial_octree.h"

namespace octotomy::convert {

/// The surface of a solid known by the share of each voxel that it fills: where shares, interpolated linearly
/// between voxel centres, pass a half, then moved along its normals until the shares that it fills itself, by
/// voxelise_partial(), are those given, on average over the 3 x 3 x 3 voxels about each point. That takes
/// away what chords cut off and what a voxel's mean is not its centre's value, the 0.8 / r^2 that
/// isosurface() is low by on a ball of r voxels, and most of its ripple. Closed, manifold, turned outward,
/// LPS millimetres. Points move by at most a tenth of a voxel's shortest edge, so that a detail finer than
/// voxels stays as the interpolation has it. Precondition: passes check(). Parallel; same bits on any thread
/// count. Cost: two runs of voxelise_partial().
brep::Triangles isosurface(const voxel::PartialOctree& partial);

}  // namespace octotomy::convert
