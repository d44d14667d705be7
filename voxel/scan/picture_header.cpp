// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_header.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "voxel/picture/png_chunk.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view jpeg_begin = "\xff\xd8"sv;
constexpr std::string_view codestream_begin = "\xff\x4f\xff\x51"sv;  // start, image and tile size
constexpr std::string_view jp2_begin = "\0\0\0\x0cjP  "sv;
/// Largest length of a header that is read at the beginning of a file. A PNM header may be long because of
/// comments.
constexpr std::size_t longest_header = 1 << 16;

[[noreturn]] void refuse_claim() {
  throw InvalidInput("is a picture that claims more than the file can hold");
}

std::uint32_t big_endian_pair_at(std::string_view bytes, std::size_t at) {
  return std::uint32_t{static_cast<std::uint8_t>(bytes[at])} << 8 | static_cast<std::uint8_t>(bytes[at + 1]);
}

std::uint32_t little_endian_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i-- > 0;) number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return number;
}

/// Reads the sizes of image and tiles at the start of a JPEG 2000 codestream. Returns the largest sample that
/// its bit depth allows; 0 above 16 bits.
std::uint32_t read_codestream(std::string_view bytes, std::size_t most_bytes) {
  // Length of the header, up to the first channel's depth.
  constexpr std::size_t header_bytes = 43, depth_at = 42;
  if (!bytes.starts_with(codestream_begin))
    throw InvalidInput("is a JPEG 2000 picture that does not begin with its size");
  if (bytes.size() < header_bytes) throw InvalidInput("is a JPEG 2000 picture that ends in its header");
  const auto number = [&](std::size_t at) { return static_cast<double>(big_endian_at(bytes, at)); };
  const double channels = big_endian_pair_at(bytes, 40);
  // Memory of OpenJPEG's opj_tcp_t and opj_tccp_t, the parameters of a tile and of its channels, rounded up.
  constexpr double tile_bytes = 8192, tile_channel_bytes = 2048;
  double samples = channels, tiles = 1;
  for (const std::size_t axis : {0, 4}) {
    const double end = number(8 + axis), begin = number(16 + axis);
    const double tile = number(24 + axis), first_tile = number(32 + axis);
    if (!(begin < end && tile > 0 && first_tile <= begin))
      throw InvalidInput("is a JPEG 2000 picture without pixels");
    samples *= end - begin;
    tiles *= std::ceil((end - first_tile) / tile);
  }
  const auto most = static_cast<double>(most_bytes);
  if (4 * samples > most || tiles * (tile_bytes + tile_channel_bytes * channels) > most) refuse_claim();
  const auto depth = static_cast<std::uint8_t>(bytes[depth_at]);
  if ((depth & 0x80) != 0)
    throw InvalidInput(
        "is a JPEG 2000 picture of signed samples, which would be read as unsigned: write "
        "it as TIFF");
  return depth < 16 ? (2u << depth) - 1 : 0;
}

/// Finds the codestream among a JP2's boxes. A box has a length, four letters and data. Length 1 means that
/// the length is in the eight bytes after the letters; length 0 means that the box extends to the end of the
/// file.
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
  throw InvalidInput("is a JPEG 2000 picture without a codestream");
}

/// Checks the first frame's header. A marker is FF and a byte that is neither 00 nor FF. Most markers are
/// followed by a length that includes its own two bytes. For a picture in several scans, libjpeg keeps the
/// whole picture in memory.
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

void check_bitmap(std::string_view bytes) {
  constexpr std::size_t size_at = 14, packing_at = 30;
  constexpr std::array<std::uint32_t, 6> known{12, 40, 52, 56, 108, 124};
  const std::uint32_t size = bytes.size() >= size_at + 4 ? little_endian_at(bytes, size_at) : 0;
  if (std::find(known.begin(), known.end(), size) == known.end())
    throw InvalidInput("is a BMP picture with a header of an unknown size");
  const bool has_packing = size != known.front() && bytes.size() >= packing_at + 4;
  const std::uint32_t packing = has_packing ? little_endian_at(bytes, packing_at) : 0;
  if (packing == 1 || packing == 2)
    throw InvalidInput(
        "is a run-length-encoded BMP picture, which would be read wrongly: save it uncompressed");
}

/// The largest sample of a PNM: the third number after the two letters. Comments may stand between the
/// numbers.
std::uint32_t read_pnm(std::string_view bytes) {
  std::size_t at = 2;
  std::uint32_t number = 0;
  for (int count = 0; count < 3; ++count) {
    while (at < bytes.size() &&
           (std::isspace(static_cast<unsigned char>(bytes[at])) != 0 || bytes[at] == '#'))
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    const auto [end, error] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), number);
    if (error != std::errc())
      throw InvalidInput("is a PNM picture that does not begin with its size and its largest sample");
    at = static_cast<std::size_t>(end - bytes.data());
  }
  if (number < 1 || number > 65535)
    throw InvalidInput("is a PNM picture whose largest sample is not from 1 to 65535");
  return number;
}

std::uint32_t read_png(std::string_view bytes) {
  const std::string_view header = png_chunks(bytes).front().data;
  constexpr std::size_t depth_at = 8, colours_at = 9;
  constexpr char by_palette = 3;
  const auto depth = static_cast<std::uint8_t>(header[depth_at]);
  return depth < 8 && header[colours_at] != by_palette ? (1u << depth) - 1 : 0;
}

}  // namespace

PictureHeader read_picture_header(std::string_view bytes, std::size_t most_bytes) {
  const auto begins = [&](std::string_view letters) { return bytes.starts_with(letters); };
  if (begins(png_signature)) return {"png", read_png(bytes)};
  if (begins(jpeg_begin)) {
    check_jpeg(bytes, most_bytes);
    return {"jpeg"};
  }
  if (begins(jp2_begin)) return {"jpeg2000", read_codestream(codestream_of(bytes), most_bytes)};
  if (begins(codestream_begin.substr(0, 2))) return {"jpeg2000", read_codestream(bytes, most_bytes)};
  if (begins("BM")) {
    check_bitmap(bytes);
    return {"bmp"};
  }
  if (begins("RIFF") && bytes.substr(std::min<std::size_t>(8, bytes.size())).starts_with("WEBP"))
    return {"webp"};
  if (begins("II*\0"sv) || begins("MM\0*"sv) || begins("II+\0"sv) || begins("MM\0+"sv)) return {"tiff"};
  if (begins("\x76\x2f\x31\x01"sv)) return {"openexr"};
  if (begins("P2") || begins("P3") || begins("P5") || begins("P6")) return {"pnm", read_pnm(bytes)};
  if (begins("P1") || begins("P4") || begins("PF") || begins("Pf")) return {"pnm"};
  throw InvalidInput(
      "is not a picture in a known format: use PNG, TIFF, JPEG, WebP, BMP, PGM, EXR or JPEG 2000");
}

std::string picture_header_bytes(const std::filesystem::path& path) {
  std::ifstream in = opened(path);
  std::string bytes(longest_header, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  const std::string_view begin = bytes;
  if (begin.starts_with(png_signature) || begin.starts_with(jpeg_begin) || begin.starts_with(jp2_begin))
    bytes.append(std::istreambuf_iterator<char>(in), {});
  return bytes;
}

}  // namespace octotomy::voxel
