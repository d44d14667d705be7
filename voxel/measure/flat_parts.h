// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Area of the parts of the boundary that are flat and lie along the lattice: faces of one plane, joined by
/// edges, whose area is more than twice what the largest such part of a ball of the same area has, h sqrt(pi
/// S), h the edge across the plane. In mm^2 by the axis of their normal. A plane of the solid there is
/// digitised coherently: each part's volume is off by up to half a voxel's edge times its area. Cost: n log n
/// in the boundary's faces.
glm::dvec3 flat_parts_mm2(const Octree& octree);

}  // namespace octotomy::voxel
