// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// SHA-256 of bytes, as 64 lower-case hexadecimal digits.
std::string sha256_of(std::string_view bytes);

/// The SHA-256 of a file. For a folder: of the lines `relative path`, a zero byte, `sha256 of that file`, a
/// newline, for every regular file in it at any depth, sorted by path as bytes; so a folder's sum depends
/// only on its files' names and contents. For a pattern of image files (read_image_stack.h): the same over
/// the matching files. Throws std::runtime_error with path and reason if a file cannot be read.
std::string sha256_of_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
