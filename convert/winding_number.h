// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/triangles.h"
#include "convert/voxelise.h"

namespace octotomy::convert {

/// How often the surface winds about a point in LPS millimetres, by solid angles: 1 inside a closed surface,
/// 0 outside, and in between where holes leave it undecided. Cost: every triangle.
/// Source: Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding
/// numbers", SIGGRAPH 2013.
double winding_number(const brep::Triangles& triangles, const glm::dvec3& p_mm);

/// The voxels about whose centre the triangles wind more than a half: what a surface encloses although it has
/// holes, crosses itself, or has edges of one, three or contrary triangles. Of a closed surface these are the
/// voxels that it encloses at least once. A surface that is inside out encloses nothing. A centre exactly on
/// the surface is inside where the solid lies further along x, y or z. Throws std::invalid_argument where a
/// triangle names no point or a point is not finite; voxel::Stopped. Parallel over slabs; same bits on any
/// thread count. Cost: the triangles' footprint in the yz plane, 4 bytes a voxel of sixteen layers a thread;
/// with holes, also the voxels near their rims and the sheet across them, each times the rims' edges.
voxel::Octree voxelise_by_winding_number(const voxel::Universe& universe, const brep::Triangles& triangles,
                                         const VoxeliseOptions& options = {});

}  // namespace octotomy::convert
