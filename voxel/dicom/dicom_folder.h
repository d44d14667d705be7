// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace octotomy::voxel {

struct FolderFiles {
  std::vector<std::filesystem::path> files;  ///< regular files of a folder and its subfolders, sorted
  std::vector<std::filesystem::path>
      staged;  ///< folders of files that a run has not renamed into place, sorted
};

bool is_folder(const std::filesystem::path& path);

/// The files of a folder and its subfolders. If the path names a file, the only entry is that file. Throws
/// Error (Input) if the folder cannot be listed.
FolderFiles files_of(const std::filesystem::path& path);

}  // namespace octotomy::voxel
