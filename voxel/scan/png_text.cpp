// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/png_text.h"

#include <algorithm>
#include <stdexcept>

#include "voxel/scan/png_chunk.h"

namespace octotomy::voxel {
namespace {

/// Signature, and the header's chunk of 13 bytes.
constexpr std::size_t header_end = 8 + 12 + 13;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return number;
}

void need_png(std::string_view bytes) {
  if (bytes.size() < header_end || !bytes.starts_with(png_signature) || bytes.substr(12, 4) != "IHDR")
    throw std::invalid_argument("is no PNG picture");
}

}  // namespace

std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text) {
  need_png({reinterpret_cast<const char*>(png.data()), png.size()});
  const std::string chunk = png_chunk("tEXt", keyword + '\0' + text);
  std::vector<std::uint8_t> made = png;
  made.insert(made.begin() + header_end, chunk.begin(), chunk.end());
  return made;
}

PngText png_text(std::string_view bytes, const std::string& keyword) {
  need_png(bytes);
  PngText found{{static_cast<int>(number_at(bytes, 16)), static_cast<int>(number_at(bytes, 20))}, {}};
  const std::string begin = keyword + '\0';
  for (std::size_t at = png_signature.size(); at < bytes.size();) {
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
