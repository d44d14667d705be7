// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/staged_files.h"

#include <cerrno>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <vector>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = ".octotomy-";

void check(const std::error_code& error, const fs::path& target) {
  if (error)
    throw Error(code_of_errno(error.value()), target.string() + ": cannot be written: " + error.message());
}

/// Gives the staged file the permissions of the file that it replaces.
void need_replaceable(const fs::path& target, const fs::path& staged) {
  struct stat of_old {};
  if (::lstat(target.c_str(), &of_old) != 0) return;
  const bool is_folder = fs::is_directory(staged);
  if (is_folder ? !S_ISDIR(of_old.st_mode) : !S_ISREG(of_old.st_mode))
    throw Error(ErrorCode::Input, target.string() + ": is no " + (is_folder ? "folder" : "regular file") +
                                      " and is not replaced: choose another name");
  if (!is_folder) ::chmod(staged.c_str(), of_old.st_mode & 07777);
}

}  // namespace

fs::path behind_links(fs::path path) {
  for (int links = 0; fs::is_symlink(fs::symlink_status(path)); ++links) {
    if (links == 40)
      throw Error(ErrorCode::Input, path.string() + ": is a link that leads to itself: choose another name");
    path = path.parent_path() / fs::read_symlink(path);
  }
  return path;
}

StagedFiles::StagedFiles(const fs::path& destination)
    : destination_(destination.empty() ? "." : destination),
      unfinished_((remove_abandoned(destination_, prefix), destination_), prefix) {}

void StagedFiles::commit(const fs::path& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder()))
    if (entry.path().filename() != last) names.push_back(entry.path().filename());
  if (!last.empty()) names.push_back(last);
  std::vector<fs::path> targets;
  for (const fs::path& name : names) {
    targets.push_back(behind_links(destination_ / name));
    need_replaceable(targets.back(), folder() / name);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::error_code error;
    {
      const NamesChange change;
      fs::rename(folder() / names[i], targets[i], error);
    }
    if (error == std::errc::cross_device_link) {
      StagedFiles there(targets[i].parent_path());
      fs::copy(folder() / names[i], there.folder() / targets[i].filename(), error);
      check(error, targets[i]);
      there.commit();
    } else {
      check(error, targets[i]);
    }
  }
}

}  // namespace octotomy::voxel
