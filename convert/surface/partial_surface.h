// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::convert {

/// The surface, in LPS millimetres, of a solid known by the share of each voxel that it fills. It starts
/// where shares, interpolated linearly between voxel centres, pass a half. Then it moves along its normals
/// until its own shares, by voxelise_partial(), are the given ones on average over the 3 x 3 x 3 voxels about
/// each point. This corrects the loss from chords and the difference between a voxel's mean and its centre's
/// value. Because of both, isosurface() of a scene makes a ball of r voxels too small by 0.8 / r^2. It also
/// removes most of the ripple.
///
/// Closed, manifold, oriented outward. Points move by at most a tenth of a voxel's shortest edge, so details
/// finer than voxels stay as interpolated. Precondition: passes check(). Throws as isosurface() of a scene.
/// Parallel; same bits on any thread count. Cost: two runs of voxelise_partial().
brep::Triangles isosurface(const voxel::PartialOctree& partial, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
