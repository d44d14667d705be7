// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Chunks of PNG (ISO/IEC 15948, 5.3): length, four letters, data, CRC-32 of letters and data; big-endian.
namespace octotomy::voxel {

inline constexpr std::string_view png_signature("\x89PNG\r\n\x1a\n", 8);

/// A number as four bytes, highest first.
std::string big_endian(std::uint32_t number);
/// Reads four bytes at `at` as a number, highest first. Precondition: `bytes` contains these four bytes.
std::uint32_t big_endian_at(std::string_view bytes, std::size_t at);
std::string png_chunk(const std::string& letters, std::string_view data);

/// A view of a chunk in a picture's bytes, which must outlive it.
struct PngChunk {
  std::string_view letters, data;
};
/// All chunks from IHDR (13 bytes of data) to IEND or the end of the bytes. Ignores bytes after IEND and does
/// not check CRCs. Throws std::invalid_argument if the bytes are not a PNG or end within a chunk.
std::vector<PngChunk> png_chunks(std::string_view bytes);

/// The bytes of a PNG with a text chunk (tEXt) inserted after its header. Throws std::invalid_argument as
/// png_chunks() does. Precondition: keyword and text are ASCII, the keyword 1 to 79 characters.
std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text);

/// The size of a PNG and the text of one of its text chunks.
struct PngText {
  glm::ivec2 size_px{0};
  std::optional<std::string> text;  ///< none: the PNG has no such chunk
};
/// The size of a PNG, and the text that it stores under the given keyword. Throws std::invalid_argument as
/// png_chunks() does.
PngText png_text(std::string_view bytes, const std::string& keyword);

}  // namespace octotomy::voxel
