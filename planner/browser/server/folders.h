// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <mutex>
#include <vector>

namespace octotomy::planner::serve {

/// The folders that a page may name paths in. Links are followed before a path is judged, those to nothing
/// yet too: a file that is written there would lie behind them. All members may be called from any thread.
class Folders {
 public:
  /// Opens a folder, or the folder of a file. A folder within an open one is open already.
  void open(const std::filesystem::path& path);
  std::vector<std::filesystem::path> opened() const;
  /// Lets plans read a file, or what lies in a folder, without opening its folder to the page.
  void allow_reading(const std::filesystem::path& path);

  /// The path without links, made absolute against the first folder. Throws voxel::Error, Input, where it is
  /// in none of the folders, or its links lead in a circle.
  std::filesystem::path need_within(const std::filesystem::path& path) const;
  /// The same of a path that a plan reads, which may also be one that allow_reading() has named.
  std::filesystem::path need_readable(const std::filesystem::path& path) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::filesystem::path> opened_, readable_;
};

/// Throws voxel::Error, Input, where a scan's header names a file of samples that lies neither beside it nor
/// where plans may read: paths in headers are no permissions either. Does nothing for other kinds of scans.
void need_readable_samples(const Folders& folders, const std::filesystem::path& scan);

/// A name that stays below whatever folder it is put in: its parts are no "..", none begins with a dot, and
/// there are at most two. Throws voxel::Error, Input, for any other.
std::filesystem::path need_plain_name(const std::string& name);

/// The path, or the first of NAME-2.EXT, NAME-3.EXT, ... that is not there; ".plan.json" is one ending.
std::filesystem::path unused(const std::filesystem::path& path);
/// The same of an export: what is written beside it, as the .ele of a .node, replaces nothing either.
std::filesystem::path unused_export(const std::filesystem::path& path);

/// A file's name without folder and endings as ".nii.gz" and ".plan.json".
std::string plain_stem(const std::filesystem::path& path);

}  // namespace octotomy::planner::serve
