// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/object_cache.h"

#include <filesystem>
#include <set>

#include "voxel/scan/read_image_stack.h"

namespace octotomy::planner {

std::optional<std::string> ObjectCache::sum(const std::string& state) const {
  const std::lock_guard lock(mutex_);
  const auto found = sums_.find(state);
  return found == sums_.end() ? std::nullopt : std::optional(found->second);
}

void ObjectCache::keep_sum(const std::string& state, const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  sums_.insert_or_assign(state, sha256);
}

ObjectCache::Counts ObjectCache::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::string state_of_path(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::set<fs::path> files;
  if (fs::is_directory(path)) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
      if (entry.is_regular_file()) files.insert(entry.path());
  } else if (fs::exists(path)) {
    files.insert(path);
  } else {
    for (const fs::path& file : voxel::image_files(path)) files.insert(file);
  }
  std::string state = fs::absolute(path).lexically_normal().string();
  for (const fs::path& file : files)
    state += "\n" + file.string() + " " + std::to_string(fs::file_size(file)) + " " +
             std::to_string(fs::last_write_time(file).time_since_epoch().count());
  return state;
}

}  // namespace octotomy::planner
