// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/file_text.h"

namespace octotomy::voxel {

/// Throws Error (Input) if `path` exists and is not a regular file, because reading a pipe or a device may
/// block or never end. Accepts a missing file; its reader reports that it is missing, and what the file is
/// needed for.
inline void need_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    refuse(path, std::filesystem::is_directory(status) ? "is a folder: choose a file"
                                                       : "is a pipe or device: copy it into a file first");
}

}  // namespace octotomy::voxel
