// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/voxel/scan/picture_bytes.h"

#include <array>
#include <bit>
#include <initializer_list>
#include <vector>

#include "tests/voxel/scan/dicom_bytes.h"
#include "voxel/scan/png_chunk.h"

namespace octotomy::tests {
namespace {

using voxel::big_endian;

std::string little(std::initializer_list<std::uint32_t> all) {
  std::string text;
  for (const std::uint32_t number : all) text += DicomBytes::number(number, 4);
  return text;
}

std::string big_pair(std::uint32_t number) {
  return big_endian(number).substr(2);
}

/// Tag, type (3: of two bytes, 4: of four) and value.
using TiffEntry = std::array<std::uint32_t, 3>;

/// A page of one strip or tile, whose offset is the last entry.
std::string tiff_of(const std::vector<TiffEntry>& entries, const std::string& samples) {
  std::string bytes = std::string("II*\0", 4) + DicomBytes::number(8, 4);
  bytes += DicomBytes::number(static_cast<std::uint32_t>(entries.size()), 2);
  for (const auto& [tag, type, value] : entries)
    bytes += DicomBytes::number(tag, 2) + DicomBytes::number(type, 2) + DicomBytes::number(1, 4) +
             DicomBytes::number(value, 4);
  return bytes + DicomBytes::number(0, 4) + samples;
}

/// Where samples begin behind so many entries.
constexpr std::uint32_t behind(std::uint32_t entries) {
  return 8 + 2 + entries * 12 + 4;
}

std::string bmp_header(std::uint32_t width, std::uint32_t height, std::uint32_t pixel_bits,
                       std::uint32_t compression, std::uint32_t colours, std::size_t data_bytes) {
  const std::uint32_t begin = 54 + 4 * colours;
  const auto data = static_cast<std::uint32_t>(data_bytes);
  return "BM" + little({begin + data, 0, begin, 40, width, height}) + DicomBytes::number(1, 2) +
         DicomBytes::number(pixel_bits, 2) + little({compression, data, 2835, 2835, colours, 0});
}

std::string box(const std::string& letters, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(8 + data.size())) + letters + data;
}

}  // namespace

std::uint32_t picture_shade(std::uint32_t pixel) {
  return (37 * pixel) % 256;
}

std::string tiff() {
  std::string samples;
  for (std::uint32_t i = 0; i < picture_width * picture_height; ++i)
    samples += DicomBytes::number(1000 + 37 * i % 5000, 2);
  return tiff_of({{256, 3, picture_width},
                  {257, 3, picture_height},
                  {258, 3, 16},
                  {259, 3, 1},
                  {262, 3, 1},
                  {273, 4, behind(9)},
                  {277, 3, 1},
                  {278, 3, picture_height},
                  {279, 4, static_cast<std::uint32_t>(samples.size())}},
                 samples);
}

std::string tiff_of_tiles(std::uint32_t tile_side) {
  std::string samples;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x)
      samples += static_cast<char>(y < picture_height ? picture_shade(y * picture_width + x) : 0);
  return tiff_of({{256, 3, picture_width},
                  {257, 3, picture_height},
                  {258, 3, 8},
                  {259, 3, 1},
                  {262, 3, 1},
                  {277, 3, 1},
                  {322, 4, tile_side},
                  {323, 4, tile_side},
                  {324, 4, behind(10)},
                  {325, 4, static_cast<std::uint32_t>(samples.size())}},
                 samples);
}

std::string bmp() {
  std::string pixels;
  for (std::uint32_t i = 0; i < picture_width * picture_height; ++i)
    pixels += std::string(3, static_cast<char>(picture_shade(i)));
  return bmp_header(picture_width, picture_height, 24, 0, 0, pixels.size()) + pixels;
}

std::string bmp_of_runs(std::uint32_t width, std::uint32_t height) {
  std::string colours, runs;
  for (std::uint32_t i = 0; i < 256; ++i) colours += std::string(3, static_cast<char>(i)) + '\0';
  for (std::uint32_t y = picture_height; y-- > 0;) {  // from the bottom
    for (std::uint32_t x = 0; x < picture_width; ++x)
      runs += {'\1', static_cast<char>(picture_shade(y * picture_width + x))};
    runs += std::string(2, '\0');
  }
  runs += std::string("\0\1", 2);
  return bmp_header(width, height, 8, 1, 256, runs.size()) + colours + runs;
}

std::string pgm() {
  std::string bytes = "P5\n16 12\n255\n";
  for (std::uint32_t i = 0; i < picture_width * picture_height; ++i)
    bytes += static_cast<char>(picture_shade(i));
  return bytes;
}

std::string exr() {
  std::string bytes = little({20000630, 2});
  const auto attribute = [&](const std::string& name, const std::string& type, const std::string& value) {
    bytes +=
        name + '\0' + type + '\0' + DicomBytes::number(static_cast<std::uint32_t>(value.size()), 4) + value;
  };
  const auto floating = [](float number) { return little({std::bit_cast<std::uint32_t>(number)}); };
  const std::string window = little({0, 0, picture_width - 1, picture_height - 1});
  attribute("channels", "chlist", std::string("Y\0", 2) + little({2, 0, 1, 1}) + '\0');  // 2: floats
  attribute("compression", "compression", std::string(1, '\0'));
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", floating(1));
  attribute("screenWindowCenter", "v2f", floating(0) + floating(0));
  attribute("screenWindowWidth", "float", floating(1));
  bytes += '\0';
  const std::size_t rows = bytes.size() + std::size_t{8} * picture_height;
  for (std::uint32_t y = 0; y < picture_height; ++y)
    bytes += little({static_cast<std::uint32_t>(rows) + y * (8 + 4 * picture_width), 0});
  for (std::uint32_t y = 0; y < picture_height; ++y) {
    bytes += little({y, 4 * picture_width});
    for (std::uint32_t x = 0; x < picture_width; ++x)
      bytes += floating(static_cast<float>(picture_shade(y * picture_width + x)));
  }
  return bytes;
}

std::string blank_codestream(std::uint32_t width, std::uint32_t height) {
  std::string size = big_pair(0);
  for (const std::uint32_t number : {width, height, 0u, 0u, width, height, 0u, 0u})
    size += big_endian(number);
  size += big_pair(1) + "\x07\x01\x01";  // one channel of 8 bits, of every pixel
  const auto segment = [](const std::string& marker, const std::string& data) {
    return marker + big_pair(static_cast<std::uint32_t>(2 + data.size())) + data;
  };
  // One layer, no wavelet level, code blocks of 64 x 64; no quantisation.
  const std::string coding("\0\0\0\1\0\0\4\4\0\1", 10), steps("\x40\x40", 2);
  const std::string data = std::string("\xff\x93\0", 3);  // one empty packet
  const std::string tile =
      big_pair(0) + big_endian(static_cast<std::uint32_t>(12 + data.size())) + '\0' + '\1';
  return "\xff\x4f" + segment("\xff\x51", size) + segment("\xff\x52", coding) + segment("\xff\x5c", steps) +
         segment("\xff\x90", tile) + data + "\xff\xd9";
}

std::string jp2(const std::string& codestream, const std::string& other_box) {
  const std::string width = codestream.substr(8, 4), height = codestream.substr(12, 4);
  const std::string channels = codestream.substr(40, 2), bits = codestream.substr(42, 1);
  const std::string header = box("ihdr", height + width + channels + bits + std::string("\7\0\0", 3)) +
                             box("colr", std::string("\1\0\0", 3) + big_endian(17));  // grey
  return box("jP  ", "\r\n\x87\n") + box("ftyp", "jp2 " + big_endian(0) + "jp2 ") + box("jp2h", header) +
         (other_box.empty() ? "" : box("free", other_box)) + box("jp2c", codestream);
}

}  // namespace octotomy::tests
