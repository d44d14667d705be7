// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::planner {

struct RemovedPicture {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
};

/// Draws the samples that a step overwrote in red on the scan before the step. There are five slices across
/// each of the lattice's axes, one row for each axis, in true scale; -1000 to 600 HU are black to white.
/// Throws std::invalid_argument if the scans are not int16 samples on the same lattice.
RemovedPicture removed_picture(const voxel::Scene& before, const voxel::Scene& after);

}  // namespace octotomy::planner
