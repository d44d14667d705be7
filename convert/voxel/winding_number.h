// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// How often the surface winds about a point in LPS millimetres, by solid angles: 1 inside a closed surface,
/// 0 outside, in between near holes. Cost: every triangle.
/// Source: Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding
/// numbers", SIGGRAPH 2013.
double winding_number(const brep::Triangles& triangles, const glm::dvec3& p_mm);

/// The voxels about whose centre the triangles have a winding number above 1/2: those that the surface
/// encloses, even if the surface has holes, crosses itself, or has edges with one, three or inconsistently
/// oriented triangles. For a closed surface these are the voxels that it encloses at least once. A surface
/// that is inside out encloses nothing. A centre exactly on the surface is inside if the solid lies further
/// along x, y or z. Throws voxel::Error (Geometry) if a triangle names no point or a point is not finite;
/// voxel::Stopped. Parallel; same bits on any thread count. Cost: the triangles' footprint in the yz plane
/// and the blocks of 16^3 voxels that they touch, in time and memory; not the universe. Holes add a cost:
/// for each voxel near a rim or near the sheet across a hole, the logarithm of the number of edges of the rims.
voxel::Octree voxelise_by_winding_number(const voxel::Universe& universe, const brep::Triangles& triangles,
                                         const voxel::Progress& progress = {});

}  // namespace octotomy::convert
