// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// The voxels whose centre is inside a closed mesh (D3), by parity along rays parallel to the universe's x
/// axis. A crossing through an edge or vertex counts once, by the half-open rule, so solids that share a face
/// share no voxel. A centre exactly on the surface is inside if the solid lies further along x, y or z. The
/// mesh may reach out of the universe.
/// Precondition: no self-intersection; otherwise parity decides. Throws voxel::Error (Geometry) if the mesh
/// is open, naming a place, or a vertex is not finite; voxel::Stopped. Parallel over slabs; same bits on any
/// thread count. Cost: the triangles' footprint in the yz plane; memory 72 bytes a triangle and 8 bytes a
/// block of 16^3 voxels.
voxel::Octree voxelise(const voxel::Universe& universe, const brep::Linked& solid,
                       const voxel::Progress& progress = {});

}  // namespace octotomy::convert
