// SPDX-License-Identifier: AGPL-3.0-or-later
// Chunks of PNG (ISO/IEC 15948, 5.3): length, four letters, data, CRC-32 of letters and data; big-endian.
#include "voxel/scan/png_text.h"

#include <algorithm>
#include <stdexcept>
#include <zlib.h>

namespace octotomy::voxel {
namespace {

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);
/// Signature, and the header's chunk of 13 bytes.
constexpr std::size_t header_end = 8 + 12 + 13;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return number;
}

std::string four_bytes(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

void need_png(std::string_view bytes) {
  if (bytes.size() < header_end || !bytes.starts_with(signature) || bytes.substr(12, 4) != "IHDR")
    throw std::invalid_argument("is no PNG picture");
}

}  // namespace

std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text) {
  need_png({reinterpret_cast<const char*>(png.data()), png.size()});
  const std::string checked = "tEXt" + keyword + '\0' + text;
  const auto crc = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
  const std::string chunk =
      four_bytes(static_cast<std::uint32_t>(checked.size() - 4)) + checked + four_bytes(crc);
  std::vector<std::uint8_t> made = png;
  made.insert(made.begin() + header_end, chunk.begin(), chunk.end());
  return made;
}

PngText png_text(std::string_view bytes, const std::string& keyword) {
  need_png(bytes);
  PngText found{{static_cast<int>(number_at(bytes, 16)), static_cast<int>(number_at(bytes, 20))}, {}};
  const std::string begin = keyword + '\0';
  for (std::size_t at = signature.size(); at < bytes.size();) {
    if (bytes.size() - at < 12 || bytes.size() - at - 12 < number_at(bytes, at))
      throw std::invalid_argument("is a PNG picture that ends within a chunk");
    const std::size_t length = number_at(bytes, at);
    const std::string_view data = bytes.substr(at + 8, length);
    if (bytes.substr(at + 4, 4) == "tEXt" && data.starts_with(begin))
      found.text = std::string(data.substr(begin.size()));
    at += 12 + length;
  }
  return found;
}

}  // namespace octotomy::voxel
