// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "voxel/space/unfinished_folder.h"

namespace octotomy::voxel {

/// A hidden folder beside the files to be written. Files are written into it under their own names and
/// renamed into place together, so that a failure half-way leaves the old files. The destructor removes the
/// folder; a folder that a killed process left is removed by the next process.
class StagedFiles {
 public:
  /// Throws Error (Input or Resource) with `destination` if no folder can be created in it.
  explicit StagedFiles(const std::filesystem::path& destination);

  const std::filesystem::path& folder() const { return unfinished_.path(); }
  /// Renames every staged file or folder into the destination, `last` (a file name) after all others, so that
  /// a header never appears before its data. A link at the destination is followed, also to another disk. A
  /// replaced file's permissions are kept. Throws Error (Input or Resource) with path and reason; a device,
  /// pipe or folder is not replaced by a file. After a failure every old file is still there: all targets are
  /// checked before the first file is renamed, and if a rename fails, the earlier ones are undone.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path destination_;
  UnfinishedFolder unfinished_;
};

/// Files for several destination folders, renamed into place together like those of one StagedFiles.
class StagedOutputs {
 public:
  /// The path of the hidden file to write instead of `place`. To be called once per place. Throws as the
  /// constructor of StagedFiles does.
  std::filesystem::path beside(const std::filesystem::path& place);
  /// Renames all files into place as StagedFiles::commit() does. The files are renamed in the order in which
  /// beside() was called for them, after any other files staged with them.
  void commit();

 private:
  std::map<std::filesystem::path, StagedFiles> folders_;
  std::vector<std::filesystem::path> places_;
};

/// The file to which a path leads after all links at its end are followed; the file may be missing. Throws
/// Error (Input) if the links form a circle.
std::filesystem::path behind_links(std::filesystem::path path);

/// The absolute path of the file or folder to which the system resolves a path: folders' links are resolved
/// before a ".." after them, links at the end are followed, even to a missing file, and a "/" at the end is
/// ignored. Throws as behind_links() does.
std::filesystem::path place_of(const std::filesystem::path& path);

/// The shortest absolute form of a path: without "." and "..". Links are not resolved, except those followed
/// by "..".
std::filesystem::path absolute_of(const std::filesystem::path& path);

/// Whether two paths lead to one file, through symbolic or hard links or another spelling. The files need not
/// exist. Throws as behind_links() does.
bool are_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace octotomy::voxel
