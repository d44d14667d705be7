// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// SHA-256 of bytes as 64 lower-case hexadecimal digits.
std::string sha256_of(std::string_view bytes);

/// SHA-256 of a file, a folder or a pattern of image files. For a file, that of its bytes. For a folder, that
/// of a text with a line for each regular file below it, sorted by path as bytes: relative path, a zero byte,
/// the SHA-256 of the file, a newline. So a folder's sum depends only on names and contents. For a pattern
/// (read_image_stack.h), the same for the matching files. Throws std::runtime_error with path and reason if a
/// file cannot be read.
std::string sha256_of_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
