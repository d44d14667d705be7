// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Chunks of PNG (ISO/IEC 15948, 5.3): length, four letters, data, CRC-32 of letters and data; big-endian.
namespace octotomy::voxel {

inline constexpr std::string_view png_signature("\x89PNG\r\n\x1a\n", 8);

/// Four bytes, and what four bytes tell; they must be there.
std::string png_number(std::uint32_t number);
std::uint32_t png_number_at(std::string_view bytes, std::size_t at);
std::string png_chunk(const std::string& letters, std::string_view data);

/// A chunk of a picture whose bytes are kept elsewhere.
struct PngChunk {
  std::string_view letters, data;
};
/// All chunks, from IHDR, of 13 bytes, to IEND or the end; what follows IEND is none of the picture's. CRCs
/// are not looked at. Throws std::invalid_argument if the bytes are no PNG, or end within a chunk.
std::vector<PngChunk> png_chunks(std::string_view bytes);

}  // namespace octotomy::voxel
