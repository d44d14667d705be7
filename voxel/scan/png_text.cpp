// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/png_text.h"

#include "voxel/scan/png_chunk.h"

namespace octotomy::voxel {

std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text) {
  const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
  const std::string_view header = png_chunks(bytes).front().data;
  const auto end = header.data() + header.size() + 4 - bytes.data();  // behind its CRC
  const std::string chunk = png_chunk("tEXt", keyword + '\0' + text);
  std::vector<std::uint8_t> made = png;
  made.insert(made.begin() + end, chunk.begin(), chunk.end());
  return made;
}

PngText png_text(std::string_view bytes, const std::string& keyword) {
  const std::vector<PngChunk> chunks = png_chunks(bytes);
  const std::string_view header = chunks.front().data;
  PngText found{{static_cast<int>(png_number_at(header, 0)), static_cast<int>(png_number_at(header, 4))}, {}};
  const std::string begin = keyword + '\0';
  for (const PngChunk& chunk : chunks)
    if (chunk.letters == "tEXt" && chunk.data.starts_with(begin))
      found.text = std::string(chunk.data.substr(begin.size()));
  return found;
}

}  // namespace octotomy::voxel
