// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

// Grey pictures put together by hand, of formats that the program reads and does not write: 16 x 12 pixels in
// shades of 8 bits, unless a size is given, which their pixels then need not fill.
namespace octotomy::tests {

inline constexpr std::uint32_t picture_width = 16, picture_height = 12;

/// The shade of a pixel, 0 to 255, counted row by row from the top left.
std::uint32_t picture_shade(std::uint32_t pixel);

std::string tiff();  ///< samples of 16 bits in one strip, uncompressed
std::string tiff_of_tiles(std::uint32_t tile_side);
std::string bmp();
std::string bmp_of_runs(std::uint32_t width = picture_width, std::uint32_t height = picture_height);
std::string pgm();
std::string exr();  ///< floats
/// JPEG 2000's codestream of a picture without detail, all in one shade.
std::string blank_codestream(std::uint32_t width, std::uint32_t height);
/// A codestream in the boxes of a .jp2, with another box before it.
std::string jp2(const std::string& codestream, const std::string& other_box = "");

}  // namespace octotomy::tests
