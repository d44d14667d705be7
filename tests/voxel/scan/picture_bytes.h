// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

// Grey pictures put together by hand, of formats that the program reads and does not write: 16 x 12 pixels in
// shades of 8 bits, unless a size or depth is given. A size need not be filled by pixels.
namespace octotomy::tests {

inline constexpr std::uint32_t picture_width = 16, picture_height = 12;

/// The shade of a pixel, 0 to 255, counted row by row from the top left.
std::uint32_t picture_shade(std::uint32_t pixel);

std::string tiff();  ///< samples of 16 bits in one strip, uncompressed
/// Samples of any bits, as they lie in the file; `kind` 1: unsigned, 2: signed, 3: floating.
std::string tiff_of(std::uint32_t bits, std::uint32_t kind, const std::string& samples);
std::string tiff_of_tiles(std::uint32_t tile_width, std::uint32_t tile_height);
std::string bmp();
/// Sealed by its checksums; `colours` 0: grey, 4: with what covers it.
std::string png(std::uint32_t bits, char colours, const std::string& rows);
std::string pgm(std::uint32_t largest = 255);  ///< its shades go up to the largest
std::string exr();                             ///< floats
/// JPEG 2000's codestream of a picture without detail, all in the middle shade. `depth`: one less than its
/// bits, and 128 more if they are signed.
std::string blank_codestream(std::uint32_t width, std::uint32_t height, char depth = 7);
/// A codestream in the boxes of a .jp2, with another box before it.
std::string jp2(const std::string& codestream, const std::string& other_box = "");

}  // namespace octotomy::tests
