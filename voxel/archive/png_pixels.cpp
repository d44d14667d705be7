// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/archive/png_pixels.h"

#include <cstdlib>
#include <string>
#include <zlib.h>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

constexpr int most_side_px = 8192;

[[noreturn]] void refuse_png(const std::string& what) {
  throw Error(ErrorCode::Input, "cannot be read as a PNG: " + what);
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  return value;
}

/// Of the left, upper and upper left neighbour, the value nearest to left + above - corner (filter type 4).
int paeth(int left, int above, int corner) {
  const int from_left = std::abs(above - corner), from_above = std::abs(left - corner),
            from_corner = std::abs(left + above - 2 * corner);
  if (from_left <= from_above && from_left <= from_corner) return left;
  return from_above <= from_corner ? above : corner;
}

/// Reverses the filters that the encoder applied to the rows. Each row's first byte is the number of its
/// filter.
void unfilter(std::vector<std::uint8_t>& rows, std::size_t row_bytes, std::size_t pixel_bytes) {
  for (std::size_t at = 0; at < rows.size(); at += row_bytes + 1) {
    const int filter = rows[at];
    if (filter > 4) refuse_png("a row has an unknown filter");
    for (std::size_t i = 1; i <= row_bytes; ++i) {
      const int left = i > pixel_bytes ? rows[at + i - pixel_bytes] : 0;
      const int above = at > 0 ? rows[at + i - row_bytes - 1] : 0;
      const int corner = at > 0 && i > pixel_bytes ? rows[at + i - row_bytes - 1 - pixel_bytes] : 0;
      const int expected = filter == 1   ? left
                           : filter == 2 ? above
                           : filter == 3 ? (left + above) / 2
                           : filter == 4 ? paeth(left, above, corner)
                                         : 0;
      rows[at + i] = static_cast<std::uint8_t>(rows[at + i] + expected);
    }
  }
}

}  // namespace

ColourPixels png_pixels(std::string_view png) {
  if (!png.starts_with(std::string_view("\x89PNG\r\n\x1a\n", 8)))
    refuse_png("its first bytes are not a PNG's signature");
  ColourPixels made;
  std::size_t channels = 0;
  std::string packed;
  bool has_end = false;
  for (std::size_t at = 8; !has_end;) {
    if (png.size() - at < 12) refuse_png("it is cut short");
    const std::uint32_t length = big_endian(png.substr(at));
    const std::string_view kind = png.substr(at + 4, 4);
    if (length > png.size() - at - 12) refuse_png("it is cut short");
    const std::string_view bytes = png.substr(at + 8, length);
    if (kind == "IHDR") {
      if (length != 13) refuse_png("its header is damaged");
      const std::uint32_t width = big_endian(bytes), height = big_endian(bytes.substr(4));
      if (width < 1 || height < 1 || width > most_side_px || height > most_side_px)
        refuse_png("its width or height is not from 1 to " + std::to_string(most_side_px) + " pixels");
      if (bytes[8] != 8 || (bytes[9] != 0 && bytes[9] != 2 && bytes[9] != 4 && bytes[9] != 6) ||
          bytes[12] != 0)
        refuse_png("its pixels are not grey or RGB with 8 bits a channel, or it is interlaced");
      channels = bytes[9] == 0 ? 1 : bytes[9] == 4 ? 2 : bytes[9] == 2 ? 3 : 4;
      made.size_px = {static_cast<int>(width), static_cast<int>(height)};
    }
    if (kind == "IDAT") packed += bytes;
    has_end = kind == "IEND";
    at += 12 + length;
  }
  if (channels == 0) refuse_png("it has no header");
  const auto width = static_cast<std::size_t>(made.size_px.x),
             height = static_cast<std::size_t>(made.size_px.y);
  std::vector<std::uint8_t> rows((width * channels + 1) * height);
  uLongf size = rows.size();
  if (uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
      size != rows.size())
    refuse_png("its pixels are damaged");
  unfilter(rows, width * channels, channels);
  made.rgb.reserve(width * height * 3);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        made.rgb.push_back(rows[y * (width * channels + 1) + 1 + x * channels + (channels < 3 ? 0 : c)]);
  return made;
}

}  // namespace octotomy::voxel
