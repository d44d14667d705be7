// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/scan/image_file_oiio.h"

namespace octotomy::voxel {

/// An ASCII text with a keyword, stored in pictures whose format supports texts.
struct ImageText {
  std::string keyword, text;
};

/// Encodes 8-bit sRGB pixels, row by row from the top left, as `format` ("png", "jpeg", "webp"). JPEG and
/// WebP are lossy, at quality 92 of 100. A PNG also stores `text` (png_chunk.h). OpenImageIO is in
/// octotomy_image_io.so, loaded on first use: linked in, it would add 0.2 s to every start of the program.
/// Throws std::invalid_argument if the size is not positive or does not match the number of pixels; Error
/// (Input) for any other format; Error (Resource) if the library cannot be loaded. Safe from several threads.
std::vector<std::uint8_t> encode_image(const std::string& format, const glm::ivec2& size_px,
                                       const std::vector<std::uint8_t>& rgb,
                                       const std::optional<ImageText>& text = std::nullopt);

/// Writes a picture in the format of the extension (.png, .jpg, .jpeg, .webp), to a temporary file that is
/// renamed into place. Throws as encode_image() does, with the path, and Error (Resource) if the disk is full
/// or fails.
void write_image(const std::filesystem::path& path, const glm::ivec2& size_px,
                 const std::vector<std::uint8_t>& rgb, const std::optional<ImageText>& text = std::nullopt);

/// The version of OpenImageIO that is loaded, for example 2.4.7. Throws Error (Resource) if it cannot be
/// loaded.
std::string image_library_version();

/// Reads the pages of a file, as grey images. The format is recognised by the first bytes: PNG, TIFF, JPEG,
/// WebP, BMP, PNM, EXR or JPEG 2000. Throws Error with path and reason: Input, or Resource if the library
/// cannot be loaded. Memory: the pages, in total at most 64 MiB or, if that is more, 1100 times the file's
/// size; the format's reader uses two or three times as much in addition.
std::vector<StoredImage> read_images(const std::filesystem::path& path);

}  // namespace octotomy::voxel
