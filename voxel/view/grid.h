// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/view/camera.h"
#include "voxel/view/pen.h"

namespace octotomy::voxel {

/// Lines at multiples of a length over a picture in true scale.
struct Grid {
  double spacing_mm = 10.0;   ///< above 0
  glm::dvec2 corner_mm{0.0};  ///< what the picture's top left corner shows, in the view's millimetres
  double pixel_mm = 1.0;
};

/// The grid of an orthographic picture.
Grid grid_of(const ImagePlane& plane, double spacing_mm);

/// Blends the lines into the pixels; those that bear a label are stronger. Throws std::invalid_argument where
/// lines would be nearer to each other than four pixels, or farther apart than the picture is wide and high.
void draw_grid(const Canvas& canvas, const Grid& grid);

/// The picture with the lines' places, in mm, in a margin that is added at the right and below, so that
/// pixels keep their places and no label lies on the anatomy. Returns the new size.
glm::ivec2 add_grid_margin(std::vector<std::uint8_t>& rgb, const glm::ivec2& size_px, const Grid& grid);

}  // namespace octotomy::voxel
