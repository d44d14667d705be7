// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

// Chunks of PNG (ISO/IEC 15948, 5.3): length, four letters, data, CRC-32 of letters and data; big-endian.
namespace octotomy::voxel {

inline constexpr std::string_view png_signature("\x89PNG\r\n\x1a\n", 8);

/// Four bytes.
std::string png_number(std::uint32_t number);
std::string png_chunk(const std::string& letters, std::string_view data);

}  // namespace octotomy::voxel
