// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::planner {

struct RemovedPicture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
};

/// Draws what was taken out of a scan in red over the scan as it was: five slices across each of the
/// lattice's axes, one row an axis, in true scale, -1000 to 600 HU from black to white. The octree is the one
/// of HeadrestRemoval for this scene. Precondition: int16 samples.
RemovedPicture removed_picture(const voxel::Scene& clean, const voxel::GreyOctree& removed);

}  // namespace octotomy::planner
