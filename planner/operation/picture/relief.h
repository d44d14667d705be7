// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/view/render.h"

namespace octotomy::planner {

/// A depth image as a surface over its own plane (thesis, figures 5.9 and 5.10).
struct Relief {
  std::vector<std::uint8_t> rgb;  ///< of the picture's size, 3 bytes per pixel
  std::uint64_t corners = 0;      ///< corners of the grid that lie on objects
  std::uint64_t levels = 0;       ///< different depths among these
};

/// Draws the depths of a picture as a grid of `cells` squares along its longer side, seen isometrically from
/// the lower right, in black lines; near cells hide far ones. Depth and the picture's plane have one scale;
/// the background lies in the plane of the farthest lit depth. Precondition: 1 <= cells.
Relief relief_of(const voxel::Picture& picture, int cells);

}  // namespace octotomy::planner
