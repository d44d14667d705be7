// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/image_file_oiio.h"

namespace octotomy::voxel {

/// Encodes 8-bit sRGB pixels, row by row from the top left, as `format` ("png", "jpeg", "webp"). The library
/// that does it, octotomy_image_io.so beside the program, is loaded on first use: linked in, OpenImageIO
/// would cost every start of the program 0.2 s. JPEG and WebP lose a little, at quality 92 of 100. Throws
/// std::invalid_argument where the size is not positive or not that of the pixels, std::runtime_error where
/// the library is not there or does not know the format. Safe from several threads.
std::vector<std::uint8_t> encode_image(const std::string& format, const glm::ivec2& size_px,
                                       const std::vector<std::uint8_t>& rgb);

/// The same to a file, as its extension says (.png, .jpg, .jpeg, .webp); written beside and renamed into
/// place. Throws as encode_image, and std::runtime_error with path and reason.
void write_image(const std::filesystem::path& path, const glm::ivec2& size_px,
                 const std::vector<std::uint8_t>& rgb);

/// The grey images of a file in any format that OpenImageIO reads, one a page of it. Throws
/// std::runtime_error with path and reason. Memory: at most 64 MiB or 1100 times the file.
std::vector<StoredImage> read_images(const std::filesystem::path& path);

}  // namespace octotomy::voxel
