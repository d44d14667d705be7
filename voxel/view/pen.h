// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::voxel {

/// A picture to draw on: 8-bit sRGB pixels, row by row from the top left. Positions count from the picture's
/// top left corner, y down; pixel (i, j) has its centre at (i + 1/2, j + 1/2).
struct Canvas {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t>* rgb = nullptr;  ///< 3 bytes per pixel
};

/// Pixel positions of the line's points; a repeated point draws a dot.
using Polyline = std::vector<glm::dvec2>;

struct Pen {
  double width_px = 1.0;
  glm::vec3 colour{0.0f};  ///< sRGB, 0..1
  double halo_px = 0.0;    ///< width of a border that keeps the line legible on any background
  glm::vec3 halo{1.0f};    ///< sRGB, 0..1
};

/// Draws lines with round ends and joints, clipped at the picture's edges. The lines of one call merge: a
/// pixel's coverage is that of the nearest line. Cost: linear in the number of pixels near the lines.
void draw_lines(const Canvas& canvas, const std::vector<Polyline>& lines, const Pen& pen);

/// Fills the pixels from `first` up to, not including, `last` with an sRGB colour.
void fill_rectangle(const Canvas& canvas, const glm::ivec2& first, const glm::ivec2& last,
                    const glm::vec3& colour);

}  // namespace octotomy::voxel
