// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "voxel/scan/png_chunk.h"

namespace octotomy::voxel {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view codestream_begin = "\xff\x4f\xff\x51"sv;  // start, image and tile size
constexpr std::string_view jp2_begin = "\0\0\0\x0cjP  "sv;
constexpr std::size_t codestream_header_bytes = 42;

/// A codestream's header of image and tile size, from its start.
void check_codestream(std::string_view header, std::size_t most_bytes) {
  if (header.size() < codestream_header_bytes)
    throw std::invalid_argument("is a JPEG 2000 picture that ends in its header");
  const auto number = [&](std::size_t at) { return static_cast<double>(big_endian_at(header, at)); };
  const auto channels = static_cast<double>(big_endian_at(header, 38) & 0xffff);
  // What OpenJPEG takes for a tile, and for each of its channels.
  constexpr double tile_bytes = 8192, tile_channel_bytes = 2048;
  double samples = channels, tiles = 1;
  for (const std::size_t axis : {0, 4}) {
    const double end = number(8 + axis), begin = number(16 + axis);
    const double tile = number(24 + axis), first_tile = number(32 + axis);
    if (!(begin < end && tile > 0 && first_tile <= begin))
      throw std::invalid_argument("is a JPEG 2000 picture without pixels");
    samples *= end - begin;
    tiles *= (end - first_tile) / tile + 1;
  }
  if (4 * samples + tiles * (tile_bytes + tile_channel_bytes * channels) > static_cast<double>(most_bytes))
    throw std::invalid_argument("is a JPEG 2000 picture that claims more than the file can hold");
}

void check_bitmap(std::string_view bytes) {
  constexpr std::size_t size_at = 14;
  constexpr std::array<std::uint8_t, 6> known{12, 40, 52, 56, 108, 124};
  const bool is_known =
      bytes.size() >= size_at + 4 && bytes.substr(size_at + 1, 3) == "\0\0\0"sv &&
      std::find(known.begin(), known.end(), static_cast<std::uint8_t>(bytes[size_at])) != known.end();
  if (!is_known) throw std::invalid_argument("is a BMP picture with a header of an unknown size");
}

}  // namespace

void check_picture_header(std::string_view bytes, std::size_t most_bytes) {
  if (bytes.starts_with(png_signature))
    png_chunks(bytes);
  else if (bytes.starts_with("BM"))
    check_bitmap(bytes);
  else if (bytes.starts_with(codestream_begin))
    check_codestream(bytes, most_bytes);
  else if (bytes.starts_with(jp2_begin))
    check_codestream(bytes.substr(std::min(bytes.find(codestream_begin), bytes.size())), most_bytes);
}

std::string picture_header(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(codestream_header_bytes, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.starts_with(png_signature) || bytes.starts_with(jp2_begin))
    bytes.append(std::istreambuf_iterator<char>(in), {});
  return bytes;
}

}  // namespace octotomy::voxel
