// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_header.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "voxel/scan/png_chunk.h"

namespace octotomy::voxel {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view jpeg_begin = "\xff\xd8"sv;
constexpr std::string_view codestream_begin = "\xff\x4f\xff\x51"sv;  // start, image and tile size
constexpr std::string_view jp2_begin = "\0\0\0\x0cjP  "sv;
constexpr std::size_t longest_header = 42;  // of those that lie at the beginning: a codestream's

[[noreturn]] void refuse_claim() {
  throw std::invalid_argument("is a picture that claims more than the file can hold");
}

std::uint32_t big_endian_pair_at(std::string_view bytes, std::size_t at) {
  return std::uint32_t{static_cast<std::uint8_t>(bytes[at])} << 8 | static_cast<std::uint8_t>(bytes[at + 1]);
}

std::uint32_t little_endian_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i-- > 0;) number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return number;
}

/// A codestream's header of image and tile size, from its start.
void check_codestream(std::string_view bytes, std::size_t most_bytes) {
  constexpr std::size_t header_bytes = 42;
  if (!bytes.starts_with(codestream_begin))
    throw std::invalid_argument("is a JPEG 2000 picture that does not begin with its size");
  if (bytes.size() < header_bytes)
    throw std::invalid_argument("is a JPEG 2000 picture that ends in its header");
  const auto number = [&](std::size_t at) { return static_cast<double>(big_endian_at(bytes, at)); };
  const double channels = big_endian_pair_at(bytes, 40);
  // OpenJPEG's opj_tcp_t and opj_tccp_t, a tile's and its channels' parameters, rounded up.
  constexpr double tile_bytes = 8192, tile_channel_bytes = 2048;
  double samples = channels, tiles = 1;
  for (const std::size_t axis : {0, 4}) {
    const double end = number(8 + axis), begin = number(16 + axis);
    const double tile = number(24 + axis), first_tile = number(32 + axis);
    if (!(begin < end && tile > 0 && first_tile <= begin))
      throw std::invalid_argument("is a JPEG 2000 picture without pixels");
    samples *= end - begin;
    tiles *= std::ceil((end - first_tile) / tile);
  }
  const auto most = static_cast<double>(most_bytes);
  if (4 * samples > most || tiles * (tile_bytes + tile_channel_bytes * channels) > most) refuse_claim();
}

/// The codestream in a JP2's boxes: length, four letters, data; a length of 1 stands for eight bytes behind
/// the letters, of 0 for the rest of the file.
std::string_view codestream_of(std::string_view bytes) {
  for (std::size_t at = 0; bytes.size() - at >= 8;) {
    std::size_t header = 8, length = big_endian_at(bytes, at);
    if (length == 1 && bytes.size() - at >= 16) {
      header = 16;
      length = std::size_t{big_endian_at(bytes, at + 8)} << 32 | big_endian_at(bytes, at + 12);
    }
    if (bytes.substr(at + 4, 4) == "jp2c") return bytes.substr(at + header);
    if (length < header || length > bytes.size() - at) break;
    at += length;
  }
  throw std::invalid_argument("is a JPEG 2000 picture without a codestream");
}

/// The first frame's header. Markers are FF and a byte that is neither 00 nor FF; most have a length that
/// counts itself. Where a picture takes several scans, libjpeg keeps all of it.
void check_jpeg(std::string_view bytes, std::size_t most_bytes) {
  for (std::size_t at = jpeg_begin.size(); at + 4 <= bytes.size();) {
    const auto code = static_cast<std::uint8_t>(bytes[at + 1]);
    if (bytes[at] != '\xff' || code == 0x00 || code == 0xff) {
      ++at;
      continue;
    }
    at += 2;
    const bool stands_alone = code == 0x01 || (code >= 0xd0 && code <= 0xd7);
    if (stands_alone) continue;
    const bool is_frame = code >= 0xc0 && code <= 0xcf && code != 0xc4 && code != 0xc8 && code != 0xcc;
    if (is_frame && bytes.size() - at >= 8) {
      const double height = big_endian_pair_at(bytes, at + 3), width = big_endian_pair_at(bytes, at + 5);
      const double samples = width * height * static_cast<std::uint8_t>(bytes[at + 7]);
      if (samples > static_cast<double>(most_bytes)) refuse_claim();
      return;
    }
    at += big_endian_pair_at(bytes, at);
  }
}

void check_bitmap(std::string_view bytes, std::size_t most_bytes) {
  constexpr std::size_t size_at = 14, width_at = 18, height_at = 22, pixel_bits_at = 28;
  constexpr std::array<std::uint32_t, 6> known{12, 40, 52, 56, 108, 124};
  const std::uint32_t size = bytes.size() >= size_at + 4 ? little_endian_at(bytes, size_at) : 0;
  if (std::find(known.begin(), known.end(), size) == known.end())
    throw std::invalid_argument("is a BMP picture with a header of an unknown size");
  // One of 12 bytes has no room for a large picture.
  if (size == known.front() || bytes.size() < pixel_bits_at + 4) return;
  const auto pixels = [&](std::size_t at) {
    const double number = static_cast<std::int32_t>(little_endian_at(bytes, at));
    return std::abs(number);  // negative: from the top
  };
  const double bytes_a_pixel = std::max(1.0, (little_endian_at(bytes, pixel_bits_at) & 0xffff) / 8.0);
  if (pixels(width_at) * pixels(height_at) * bytes_a_pixel > static_cast<double>(most_bytes)) refuse_claim();
}

}  // namespace

std::string check_picture_header(std::string_view bytes, std::size_t most_bytes) {
  if (bytes.starts_with(png_signature)) {
    png_chunks(bytes);
    return "png";
  }
  if (bytes.starts_with(jpeg_begin)) {
    check_jpeg(bytes, most_bytes);
    return "jpeg";
  }
  if (bytes.starts_with(jp2_begin)) {
    check_codestream(codestream_of(bytes), most_bytes);
    return "jpeg2000";
  }
  if (bytes.starts_with(codestream_begin.substr(0, 2))) {
    check_codestream(bytes, most_bytes);
    return "jpeg2000";
  }
  if (bytes.starts_with("BM")) {
    check_bitmap(bytes, most_bytes);
    return "bmp";
  }
  if (bytes.starts_with("RIFF") && bytes.substr(std::min<std::size_t>(8, bytes.size())).starts_with("WEBP"))
    return "webp";
  for (const std::string_view begin : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (bytes.starts_with(begin)) return "tiff";
  if (bytes.starts_with("\x76\x2f\x31\x01"sv)) return "openexr";
  if (bytes.size() >= 2 && bytes[0] == 'P' && "123456Ff"sv.find(bytes[1]) != std::string_view::npos)
    return "pnm";
  throw std::invalid_argument(
      "is no picture of a known format: give PNG, TIFF, JPEG, WebP, BMP, PGM, EXR or JPEG 2000");
}

std::string picture_header(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(longest_header, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  const std::string_view begin = bytes;
  if (begin.starts_with(png_signature) || begin.starts_with(jpeg_begin) || begin.starts_with(jp2_begin))
    bytes.append(std::istreambuf_iterator<char>(in), {});
  return bytes;
}

}  // namespace octotomy::voxel
