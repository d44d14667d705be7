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
/// Reads four bytes at `at` as a number, highest first. Precondition: they are there.
std::uint32_t big_endian_at(std::string_view bytes, std::size_t at);
std::string png_chunk(const std::string& letters, std::string_view data);

/// A chunk of a picture whose bytes are kept elsewhere.
struct PngChunk {
  std::string_view letters, data;
};
/// All chunks, from IHDR, of 13 bytes, to IEND or the end; what follows IEND is none of the picture's. CRCs
/// are not looked at. Throws std::invalid_argument if the bytes are no PNG, or end within a chunk.
std::vector<PngChunk> png_chunks(std::string_view bytes);

/// A PNG's bytes with a text chunk (tEXt) behind its header. Throws std::invalid_argument as png_chunks().
/// Precondition: keyword and text are ASCII, the keyword 1 to 79 characters.
std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text);

/// What a PNG says of itself.
struct PngText {
  glm::ivec2 size_px{0};
  std::optional<std::string> text;  ///< none: it has no such chunk
};
/// The size and the text of that keyword. Throws std::invalid_argument as png_chunks().
PngText png_text(std::string_view bytes, const std::string& keyword);

}  // namespace octotomy::voxel
