// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/folders.h"

#include <algorithm>
#include <optional>

#include "convert/deck/deck.h"
#include "planner/operation/table/control_character.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// Whether `path` is the folder or lies below it.
bool holds(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// The path to which a write would go: resolves all links. fs::weakly_canonical() does not resolve broken
/// links. None if links form a cycle.
std::optional<fs::path> reached(fs::path path) {
  constexpr int most_links = 40;  // the limit of Linux
  for (int links = 0; links <= most_links; ++links) {
    std::error_code failed, absent;
    path = fs::weakly_canonical(path, failed);
    if (failed) return {};
    fs::path followed;
    bool has_link = false;
    for (const fs::path& part : path) {
      followed /= part;
      if (has_link || !fs::is_symlink(fs::symlink_status(followed, absent))) continue;
      has_link = true;
      followed = followed.parent_path() / fs::read_symlink(followed, failed);
      if (failed) return {};
    }
    if (!has_link) return path;
    path = followed;
  }
  return {};
}

bool is_taken(const fs::path& path) {
  return fs::exists(fs::symlink_status(path));
}

/// Whether an export would replace no file: neither the one of this name nor those written together with it.
bool is_free_for_export(const fs::path& path) {
  for (const fs::path& file : convert::is_deck(path) ? convert::deck_files(path) : std::vector{path})
    if (is_taken(file)) return false;
  try {
    voxel::need_own_data_file(path);
  } catch (const voxel::Error&) {
    return false;
  }
  return true;
}

/// The extensions that state a file's kind, such as ".nii.gz" or ".plan.json".
std::string endings_of(const std::string& name) {
  for (const char* both : {".plan.json", ".nii.gz"})
    if (name.ends_with(both)) return both;
  return fs::path(name).extension();
}

/// The first of the path, NAME-2.EXT, NAME-3.EXT, ... for which `is_free` is true.
template <typename Test>
fs::path first_free(const fs::path& path, const Test& is_free) {
  const std::string name = path.filename(), endings = endings_of(name);
  fs::path tried = path;
  for (int number = 2; !is_free(tried); ++number)
    tried = path.parent_path() /
            (name.substr(0, name.size() - endings.size()) + "-" + std::to_string(number) + endings);
  return tried;
}

/// The path without links, made absolute against the first of `places`. Throws if it lies in none of them.
fs::path need_below(const std::vector<fs::path>& places, const fs::path& path) {
  if (path.native().find('\0') == std::string::npos && path.native().size() < 4096 && !places.empty()) {
    const std::optional<fs::path> real = reached(places.front() / path);
    for (const fs::path& place : places)
      if (real && holds(place, *real)) return *real;
  }
  std::string shown = path.string();
  std::erase(shown, '\0');
  throw voxel::Error(
      voxel::ErrorCode::Input,
      shown + ": lies in no folder that is open; start the server with it: octotomy serve PATH");
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

void Folders::allow_reading(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  readable_.push_back(fs::weakly_canonical(fs::absolute(path)));
}

fs::path Folders::need_within(const fs::path& path) const {
  const std::lock_guard lock(mutex_);
  return need_below(opened_, path);
}

fs::path Folders::need_readable(const fs::path& path) const {
  const std::lock_guard lock(mutex_);
  std::vector<fs::path> places = opened_;
  places.insert(places.end(), readable_.begin(), readable_.end());
  return need_below(places, path);
}

void need_readable_samples(const Folders& folders, const fs::path& scan) {
  if (!fs::is_regular_file(scan)) return;
  const std::optional<voxel::VolumeFormat> format = voxel::readable_volume_format(scan);
  if (!format) return;
  std::vector<fs::path> files;
  try {
    files = voxel::read_volume_header(scan, *format).samples.files;
  } catch (const voxel::Error&) {
    return;  // the scan's reader refuses it and states why
  }
  const fs::path beside = fs::weakly_canonical(fs::absolute(scan)).parent_path();
  for (const fs::path& file : files) {
    const std::optional<fs::path> real = reached(fs::absolute(file));
    if (!real || !holds(beside, *real)) folders.need_readable(fs::absolute(file));
  }
}

fs::path need_plain_name(const std::string& name) {
  fs::path path(name);
  const bool is_plain = !name.empty() && name.size() < 256 && !path.is_absolute() && path.has_filename() &&
                        std::distance(path.begin(), path.end()) <= 2 &&
                        std::all_of(path.begin(), path.end(),
                                    [](const fs::path& part) { return part.native().front() != '.'; }) &&
                        !has_control(name) && name.find('\\') == std::string::npos;
  if (!is_plain)
    throw voxel::Error(voxel::ErrorCode::Input,
                       "'" + name + "' is not a plain file name such as head.nrrd or series/1.dcm");
  return path;
}

fs::path unused(const fs::path& path) {
  return first_free(path, [](const fs::path& tried) { return !is_taken(tried); });
}

fs::path unused_export(const fs::path& path) {
  return first_free(path, is_free_for_export);
}

std::string plain_stem(const fs::path& path) {
  const std::string name = path.has_filename() ? path.filename() : path.parent_path().filename();
  return name.substr(0, name.size() - endings_of(name).size());
}

}  // namespace octotomy::planner::serve
