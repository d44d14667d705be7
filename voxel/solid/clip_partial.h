// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/partial_octree.h"

namespace octotomy::voxel {

/// The part of a solid that lies in certain whole voxels of its universe. Throws std::invalid_argument where
/// the universes differ. Precondition: passes check().
PartialOctree within(const PartialOctree& partial, const Octree& voxels);

}  // namespace octotomy::voxel
