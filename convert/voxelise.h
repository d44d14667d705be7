// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "brep/mesh.h"
#include "voxel/octree.h"

namespace octotomy::convert {

/// For the ways of voxelising that take their time.
struct VoxeliseOptions {
  std::function<void(double share)> progress{};  ///< of the work done; called from any thread, one at a time
  std::stop_token stop{};                        ///< ends the work with voxel::Stopped
};

/// The voxels whose centre is inside a closed mesh (D3), by parity along rays parallel to the universe's x
/// axis. A crossing through an edge or vertex counts once, by the half-open rule, so solids that share a face
/// share no voxel; a centre exactly on the surface is inside where the solid lies further along x, y or z.
/// The mesh may reach out of the universe. Precondition: no self-intersection, or parity decides. Throws
/// std::invalid_argument where the mesh is open, saying where, or a vertex is not finite. Parallel over
/// slabs; same bits on any thread count. Cost: the triangles' footprint in the yz plane; memory 72 bytes a
/// triangle and 8 bytes a block of 16^3 voxels.
voxel::Octree voxelise(const voxel::Universe& universe, const brep::Mesh& solid);

}  // namespace octotomy::convert
