// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/view/render.h"

namespace octotomy::planner {

/// Draws a depth image as a surface above its own plane (thesis, figures 5.9 and 5.10).
struct Relief {
  std::vector<std::uint8_t> rgb;  ///< the picture, 3 bytes per pixel
  std::uint64_t corners = 0;      ///< number of the grid's corners that lie on objects
  std::uint64_t levels = 0;       ///< different depths among these
};

/// Draws the depths of a picture as a grid with `cells` squares along the longer side, in black lines. It is
/// seen isometrically from the lower right; near cells hide far ones. Depths and the picture's plane have the
/// same scale. The background lies in the plane of the farthest lit depth. Precondition: 1 <= cells.
Relief relief_of(const voxel::Picture& picture, int cells);

}  // namespace octotomy::planner
