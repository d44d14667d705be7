// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "voxel/space/error.h"

// Error messages, file access and text functions for the readers and writers of files.
namespace octotomy::voxel {

/// Throws Error with the file and the reason.
[[noreturn]] inline void refuse(const std::filesystem::path& path, const std::string& reason,
                                ErrorCode code = ErrorCode::Input) {
  throw Error(code, path.string() + ": " + reason);
}

/// Opens a file for reading. A missing file or a folder yields a stream in the failed state. Throws Error
/// (Input) for a pipe or a device, because reading it may block or never end.
inline std::ifstream opened(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  std::ifstream in;
  if (std::filesystem::is_directory(status)) {
    in.setstate(std::ios::failbit);
    return in;
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    refuse(path, "is a pipe or device: copy it into a file first");
  in.open(path, std::ios::binary);
  return in;
}

/// All bytes of a file; none if it cannot be read. Throws as opened() does.
inline std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream in = opened(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The text in lower case; only ASCII letters change.
inline std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

/// The text without spaces, tabs and carriage returns at its ends.
inline std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// A file name's extension in lower case, with its dot; empty if there is none.
inline std::string extension_of(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
}

}  // namespace octotomy::voxel
