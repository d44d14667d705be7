// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/cuberille_faces.h"

namespace octotomy::voxel {

/// Whether a face is exposed: its voxel is in the object, the voxel across it is not.
bool is_boundary(const Octree& octree, const Face& face);

/// The faces of one connected boundary, found by tracking from a seed face: the boundary between the
/// 1-connected object (18 neighbours) and the 2-connected background (6 neighbours) that hold the voxels on
/// the seed's two sides. Cavities and other objects are boundaries of their own; voxels that touch by an edge
/// share one. Throws std::invalid_argument where the seed is not exposed.
/// Cost: two steps, each of up to two point locations, and 16 to 32 bytes a face.
/// Source: Artzy, Frieder and Herman 1981 (thesis 2.3.2.1.2).
CuberilleFaces track_boundary(const Octree& octree, const Face& seed);

}  // namespace octotomy::voxel
