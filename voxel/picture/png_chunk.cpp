// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/picture/png_chunk.h"

#include <cassert>
#include <stdexcept>
#include <zlib.h>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// The bytes of a chunk besides its data: length, letters and CRC.
constexpr std::size_t around_data = 4 + 4 + 4;

}  // namespace

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

std::uint32_t big_endian_at(std::string_view bytes, std::size_t at) {
  assert(at + 4 <= bytes.size());
  std::uint32_t number = 0;
  for (const char byte : bytes.substr(at, 4)) number = number << 8 | static_cast<std::uint8_t>(byte);
  return number;
}

std::string png_chunk(const std::string& letters, std::string_view data) {
  std::string checked = letters;
  checked += data;
  const auto crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
  return big_endian(static_cast<std::uint32_t>(data.size())) + checked + big_endian(crc);
}

std::vector<PngChunk> png_chunks(std::string_view bytes) {
  if (!bytes.starts_with(png_signature)) throw InvalidInput("is no PNG picture");
  std::vector<PngChunk> chunks;
  for (std::size_t at = png_signature.size(); at < bytes.size();) {
    const std::size_t left = bytes.size() - at;
    if (left < around_data || left - around_data < big_endian_at(bytes, at))
      throw InvalidInput("is a PNG picture that ends within a chunk");
    const std::size_t length = big_endian_at(bytes, at);
    chunks.push_back({bytes.substr(at + 4, 4), bytes.substr(at + 8, length)});
    if (chunks.back().letters == "IEND") break;
    at += around_data + length;
  }
  if (chunks.empty() || chunks.front().letters != "IHDR" || chunks.front().data.size() != 13)
    throw InvalidInput("is a PNG picture that does not begin with its size");
  return chunks;
}

std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text) {
  const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
  const std::string_view header = png_chunks(bytes).front().data;
  // End of the header chunk, after its CRC.
  const auto end = header.data() + header.size() + 4 - bytes.data();
  const std::string chunk = png_chunk("tEXt", keyword + '\0' + text);
  std::vector<std::uint8_t> made = png;
  made.insert(made.begin() + end, chunk.begin(), chunk.end());
  return made;
}

PngText png_text(std::string_view bytes, const std::string& keyword) {
  const std::vector<PngChunk> chunks = png_chunks(bytes);
  const std::string_view header = chunks.front().data;
  PngText found{{static_cast<int>(big_endian_at(header, 0)), static_cast<int>(big_endian_at(header, 4))}, {}};
  const std::string begin = keyword + '\0';
  for (const PngChunk& chunk : chunks)
    if (chunk.letters == "tEXt" && chunk.data.starts_with(begin))
      found.text = std::string(chunk.data.substr(begin.size()));
  return found;
}

}  // namespace octotomy::voxel
