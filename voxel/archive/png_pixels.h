// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace octotomy::voxel {

/// An RGB picture: three bytes a pixel, row by row from the top left.
struct ColourPixels {
  glm::ivec2 size_px{0};
  std::vector<std::uint8_t> rgb;
};

/// The pixels of a PNG with 8 bits per channel, grey or colour, not interlaced; transparency is dropped. For
/// grey slices of a scan use read_images(). Throws Error (Input) without a path, if the PNG is of another
/// kind, damaged, or has a side of more than 8192 pixels. Memory: twice the bytes of the pixels. Source: PNG
/// specification, second edition.
ColourPixels png_pixels(std::string_view png);

}  // namespace octotomy::voxel
