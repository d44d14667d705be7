// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/view/camera.h"
#include "voxel/view/pen.h"

namespace octotomy::voxel {

/// A grid over a picture in true scale, with lines at multiples of a length.
struct Grid {
  double spacing_mm = 10.0;   ///< above 0
  glm::dvec2 corner_mm{0.0};  ///< position of the picture's top left corner, in the view's millimetres
  double pixel_mm = 1.0;
};

/// The grid of an orthographic picture.
Grid grid_of(const ImagePlane& plane, double spacing_mm);

/// Blends the lines into the pixels; labelled lines are stronger. Throws std::invalid_argument if lines would
/// be less than four pixels apart, or farther apart than the picture is wide and high.
void draw_grid(const Canvas& canvas, const Grid& grid);

/// Adds a margin at the right and below the picture with the lines' positions in mm, so that no label covers
/// the anatomy. Pixels of the picture keep their positions. Returns the new size.
glm::ivec2 add_grid_margin(std::vector<std::uint8_t>& rgb, const glm::ivec2& size_px, const Grid& grid);

}  // namespace octotomy::voxel
