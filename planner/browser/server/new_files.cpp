// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/new_files.h"

#include <algorithm>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// The folder if it exists, else its nearest existing parent.
fs::path present(fs::path folder) {
  while (!fs::exists(folder)) folder = folder.parent_path();
  return folder;
}

}  // namespace

NewFiles::NewFiles(const fs::path& folder) : folder_(folder), staged_(present(folder)) {}

void NewFiles::commit(const fs::path& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(hidden()))
    names.push_back(entry.path().filename());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name != last; });
  const voxel::NamesChange change;
  fs::create_directories(folder_);
  for (const fs::path& name : names)
    if (fs::exists(fs::symlink_status(folder_ / name)))
      throw voxel::Error(voxel::ErrorCode::Input,
                         (folder_ / name).string() + ": exists already: choose another name");
  for (const fs::path& name : names) fs::rename(hidden() / name, folder_ / name);
}

}  // namespace octotomy::planner::serve
