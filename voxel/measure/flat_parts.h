// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// For each lattice axis, the area in mm^2 of the boundary's flat parts with their normal along this axis. A
/// part consists of faces of one plane joined by edges. The largest part on a ball with the same total area S
/// has the area h sqrt(pi S), where h is the voxel edge across the plane. A part is counted if its area
/// exceeds twice this value. It then lies on a plane of the solid, and all its faces have the same
/// digitisation error, which changes the volume by up to half a voxel's edge times the part's area. Cost: n
/// log n for n faces of the boundary.
glm::dvec3 flat_parts_mm2(const Octree& octree);

}  // namespace octotomy::voxel
