// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/voxel/scan/picture_bytes.h"

#include <array>
#include <bit>
#include <initializer_list>
#include <vector>
#include <zlib.h>

#include "tests/voxel/scan/dicom_bytes.h"
#include "voxel/picture/png_chunk.h"

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
std::string tiff_page(const std::vector<TiffEntry>& entries, const std::string& samples) {
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
  return tiff_of(16, 1, samples);
}

std::string tiff_of(std::uint32_t bits, std::uint32_t kind, const std::string& samples) {
  return tiff_page({{256, 3, picture_width},
                    {257, 3, picture_height},
                    {258, 3, bits},
                    {259, 3, 1},
                    {262, 3, 1},
                    {273, 4, behind(10)},
                    {277, 3, 1},
                    {278, 3, picture_height},
                    {279, 4, static_cast<std::uint32_t>(samples.size())},
                    {339, 3, kind}},
                   samples);
}

std::string tiff_of_tiles(std::uint32_t tile_width, std::uint32_t tile_height) {
  std::string samples;
  for (std::uint32_t y = 0; y < 16; ++y)
    for (std::uint32_t x = 0; x < 16; ++x)
      samples += static_cast<char>(y < picture_height ? picture_shade(y * picture_width + x) : 0);
  return tiff_page({{256, 3, picture_width},
                    {257, 3, picture_height},
                    {258, 3, 8},
                    {259, 3, 1},
                    {262, 3, 1},
                    {277, 3, 1},
                    {322, 4, tile_width},
                    {323, 4, tile_height},
                    {324, 4, behind(10)},
                    {325, 4, static_cast<std::uint32_t>(samples.size())}},
                   samples);
}

std::string bmp() {
  std::string pixels;
  for (std::uint32_t y = picture_height; y-- > 0;)  // from the bottom
    for (std::uint32_t x = 0; x < picture_width; ++x)
      pixels += std::string(3, static_cast<char>(picture_shade(y * picture_width + x)));
  const auto size = static_cast<std::uint32_t>(pixels.size());
  return "BM" + little({54 + size, 0, 54, 40, picture_width, picture_height}) + DicomBytes::number(1, 2) +
         DicomBytes::number(24, 2) + little({0, size, 2835, 2835, 0, 0}) + pixels;
}

std::string png(std::uint32_t bits, char colours, const std::string& rows) {
  std::string packed(rows.size() + 64, '\0');
  uLongf size = packed.size();
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
           rows.size());
  packed.resize(size);
  const std::string header = big_endian(picture_width) + big_endian(picture_height) +
                             static_cast<char>(bits) + colours + std::string(3, '\0');
  return std::string(voxel::png_signature) + voxel::png_chunk("IHDR", header) +
         voxel::png_chunk("IDAT", packed) + voxel::png_chunk("IEND", "");
}

std::string pgm(std::uint32_t largest) {
  std::string bytes = "P5\n# a comment of 16 12 255\n16 12\n" + std::to_string(largest) + "\n";
  for (std::uint32_t i = 0; i < picture_width * picture_height; ++i) {
    const std::uint32_t sample = largest == 255 ? picture_shade(i) : 37 * i % (largest + 1);
    if (largest > 255) bytes += static_cast<char>(sample >> 8);
    bytes += static_cast<char>(sample);
  }
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

std::string blank_codestream(std::uint32_t width, std::uint32_t height, char depth) {
  std::string size = big_pair(0);
  for (const std::uint32_t number : {width, height, 0u, 0u, width, height, 0u, 0u})
    size += big_endian(number);
  size += big_pair(1) + depth + "\1\1";  // one channel, of every pixel
  const auto segment = [](const std::string& marker, const std::string& data) {
    return marker + big_pair(static_cast<std::uint32_t>(2 + data.size())) + data;
  };
  // One layer, no wavelet level, code blocks of 64 x 64; no quantisation.
  const std::string coding("\0\0\0\1\0\0\4\4\0\1", 10);
  const std::string steps = {'\x40', static_cast<char>((depth + 1) << 3)};
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
