// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

namespace octotomy::planner::serve {

/// The folders in which a page may name paths. Links are resolved before a path is checked. That includes
/// broken links, because writing to one creates a file at its target. All members may be called from any
/// thread.
class Folders {
 public:
  /// Opens a folder, or the folder of a file. Subfolders of an open folder are open too.
  void open(const std::filesystem::path& path);
  std::vector<std::filesystem::path> opened() const;
  /// Allows plans to read a file, or all files below a folder, although the page itself may not name them.
  void allow_reading(const std::filesystem::path& path);

  /// The path without links, made absolute against the first folder. Throws voxel::Error, Input, if it is in
  /// none of the folders or its links are cyclic.
  std::filesystem::path need_within(const std::filesystem::path& path) const;
  /// As need_within(), for a path that a plan reads. The paths of allow_reading() are accepted too.
  std::filesystem::path need_readable(const std::filesystem::path& path) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::filesystem::path> opened_, readable_;
};

/// Throws voxel::Error, Input, if a scan's header names a file of samples that is neither beside the header
/// nor in a folder that plans may read. That a header names a path is no permission to read it. Does nothing
/// for scans without such a header.
void need_readable_samples(const Folders& folders, const std::filesystem::path& scan);

/// Checks a relative name: one or two parts, none of which begins with a dot. Appended to any folder, it
/// stays below that folder. Returns the name; throws voxel::Error, Input, for others.
std::filesystem::path need_plain_name(const std::string& name);

/// The path, or the first of NAME-2.EXT, NAME-3.EXT, ... that does not exist; ".plan.json" counts as one
/// extension.
std::filesystem::path unused(const std::filesystem::path& path);
/// As unused(), for an export: the files written together with it, such as the .ele of a .node, must not
/// exist either.
std::filesystem::path unused_export(const std::filesystem::path& path);

/// A file's name without its folder and its extensions, also without double ones such as ".nii.gz" and
/// ".plan.json".
std::string plain_stem(const std::filesystem::path& path);

}  // namespace octotomy::planner::serve
