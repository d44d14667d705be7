// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh.h"
#include "voxel/octree.h"

namespace octotomy::convert {

/// The voxels whose centre is inside a closed mesh (D3), by parity along rays parallel to the universe's x
/// axis: a crossing through an edge or vertex counts once, by the half-open rule. Throws
/// std::invalid_argument where the mesh is open. Cost: the triangles' footprint in the yz plane, sorted row
/// by row. Parallel over slabs.
voxel::Octree voxelise(const voxel::Universe& universe, const brep::Mesh& solid);

}  // namespace octotomy::convert
