// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/serve/folders.h"

#include <algorithm>

#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// Whether a folder is a path's beginning, part by part.
bool holds(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// The endings of a file's name that say its kind.
std::string endings_of(const std::string& name) {
  for (const char* both : {".plan.json", ".nii.gz"})
    if (name.ends_with(both)) return both;
  return fs::path(name).extension();
}

}  // namespace

void Folders::open(const fs::path& path) {
  fs::path folder = fs::weakly_canonical(fs::absolute(path));
  if (!fs::is_directory(folder)) folder = folder.parent_path();
  const std::lock_guard lock(mutex_);
  for (const fs::path& known : opened_)
    if (holds(known, folder)) return;
  opened_.push_back(folder);
}

std::vector<fs::path> Folders::opened() const {
  const std::lock_guard lock(mutex_);
  return opened_;
}

fs::path Folders::need_within(const fs::path& path) const {
  const std::lock_guard lock(mutex_);
  if (path.native().find('\0') == std::string::npos && path.native().size() < 4096 && !opened_.empty()) {
    std::error_code failed;
    const fs::path real = fs::weakly_canonical(opened_.front() / path, failed);
    for (const fs::path& folder : opened_)
      if (!failed && holds(folder, real)) return real;
  }
  std::string shown = path.string().substr(0, 200);
  std::erase(shown, '\0');
  throw voxel::Error(
      voxel::ErrorCode::Input,
      shown + ": lies in no folder that is open; start the server with it: octotomy serve PATH");
}

fs::path need_plain_name(const std::string& name) {
  const fs::path path(name);
  const bool is_plain = !name.empty() && name.size() < 256 && !path.is_absolute() && path.has_filename() &&
                        std::distance(path.begin(), path.end()) <= 2 &&
                        std::all_of(path.begin(), path.end(),
                                    [](const fs::path& part) { return part.native().front() != '.'; }) &&
                        std::none_of(name.begin(), name.end(), [](char symbol) {
                          return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f || symbol == '\\';
                        });
  if (!is_plain)
    throw voxel::Error(voxel::ErrorCode::Input,
                       "'" + name.substr(0, 100) + "' is no plain file name, as head.nrrd or series/1.dcm");
  return path;
}

fs::path unused(const fs::path& path) {
  const std::string name = path.filename(), endings = endings_of(name);
  fs::path tried = path;
  for (int number = 2; fs::exists(fs::symlink_status(tried)); ++number)
    tried = path.parent_path() /
            (name.substr(0, name.size() - endings.size()) + "-" + std::to_string(number) + endings);
  return tried;
}

std::string plain_stem(const fs::path& path) {
  const std::string name = path.has_filename() ? path.filename() : path.parent_path().filename();
  return name.substr(0, name.size() - endings_of(name).size());
}

}  // namespace octotomy::planner::serve
