// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_folder.h"

#include <algorithm>

#include "voxel/space/file_text.h"

namespace octotomy::voxel {

namespace fs = std::filesystem;

namespace {

/// Whether an entry is a regular file or a broken link. Broken links are included so that they are reported
/// as unreadable.
bool is_file(const fs::directory_entry& entry) {
  std::error_code ignored;
  return entry.is_regular_file(ignored) || (entry.is_symlink(ignored) && !entry.exists(ignored));
}

/// Whether a path names a folder of staged files, which are not yet renamed into place, or the list of a
/// result's files.
bool is_of_octotomy(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') && name.find(".octotomy-") != std::string::npos;
}

}  // namespace

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

FolderFiles files_of(const fs::path& path) {
  if (!is_folder(path)) return {{path}, {}};
  FolderFiles found;
  std::error_code error, is_closed;
  fs::recursive_directory_iterator entry(path, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
    if (is_of_octotomy(entry->path())) {
      entry.disable_recursion_pending();
      if (is_folder(entry->path()) && !fs::is_empty(entry->path(), is_closed))
        found.staged.push_back(entry->path());
    } else if (is_file(*entry)) {
      found.files.push_back(entry->path());
    }
  if (error) refuse(path, "the folder cannot be listed: " + error.message());
  std::sort(found.files.begin(), found.files.end());
  std::sort(found.staged.begin(), found.staged.end());
  return found;
}

}  // namespace octotomy::voxel
