// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// Encodes 8-bit sRGB pixels, row by row from the top left, as `format` ("png", "jpeg", "webp"). OpenImageIO
/// is loaded on first use: linked in, it would cost every start of the program 0.2 s.
/// Throws std::runtime_error where the module or the format is not there.
std::vector<std::uint8_t> encode_image(const std::string& format, const glm::ivec2& size_px,
                                       const std::vector<std::uint8_t>& rgb);

/// The same to a file, as its extension says; written beside and renamed into place.
void write_image(const std::filesystem::path& path, const glm::ivec2& size_px,
                 const std::vector<std::uint8_t>& rgb);

}  // namespace octotomy::voxel
