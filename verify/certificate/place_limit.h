// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::verify {

/// The size from which on the comparison of places detects all errors that were injected in this object.
/// Errors are injected at random places and judged by the rules of judge_places(): groups of voxels next to
/// the boundary are removed and added, pieces of the mesh are removed, and the whole mesh is shifted along
/// three axes, both ways. `digitised` are the voxels whose centre lies inside the solid; `boundary` belongs
/// to the octree. Same answer on any thread count. Cost: about ten thousand readings of the witness, and a
/// sort of the solid's pieces.
DetectionLimit place_limit(const voxel::Octree& octree, const voxel::Octree& digitised,
                           const brep::Solid& solid, const std::vector<voxel::VoxelFace>& boundary,
                           const Witness& witness);

}  // namespace octotomy::verify
