// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Area of the flat parts of the boundary along the lattice, in mm^2, by the axis of their normal. A part
/// consists of faces of one plane joined by edges. The largest part on a ball with the same total area S has
/// the area h sqrt(pi S), where h is the voxel edge across the plane. A part counts if its area exceeds twice
/// this value. It then comes from a plane of the solid, and all its faces have the same digitisation error:
/// the part's volume is wrong by up to half a voxel's edge times its area. Cost: n log n in the boundary's
/// faces.
glm::dvec3 flat_parts_mm2(const Octree& octree);

}  // namespace octotomy::voxel
