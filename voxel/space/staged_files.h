// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "voxel/space/unfinished_folder.h"

namespace octotomy::voxel {

/// A hidden folder beside the files to be written. Files are written into it under their own names and
/// renamed into place together, so that a failure half-way leaves the old ones. Removed with the object; what
/// a killed process left there is removed by the next one.
class StagedFiles {
 public:
  /// Throws Error, Input or Resource, that names `destination` if no folder can be made in it.
  explicit StagedFiles(const std::filesystem::path& destination);

  const std::filesystem::path& folder() const { return unfinished_.path(); }
  /// Renames every staged file or folder into the destination, `last` (a file name) after all others, so that
  /// a header never appears before its data. A link there is followed, also to another disk; a file there
  /// hands on its permissions. Throws Error, Input or Resource, with path and reason; a device, pipe or
  /// folder is not replaced. A failure leaves every old file: all targets are looked at before the first is
  /// renamed, and names that were given are taken back where a later one fails.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path destination_;
  UnfinishedFolder unfinished_;
};

/// Files for places in any folders, which are renamed into place together like those of one StagedFiles.
class StagedOutputs {
 public:
  /// The hidden file to write in place of `place`, once each. Throws as StagedFiles.
  std::filesystem::path beside(const std::filesystem::path& place);
  /// As StagedFiles::commit(). The files take their names in the order in which they were asked for, after
  /// what was written next to them.
  void commit();

 private:
  std::map<std::filesystem::path, StagedFiles> folders_;
  std::vector<std::filesystem::path> places_;
};

/// The file that a path means: links at its end followed, even one to nothing yet. Throws Error (Input) if
/// the links lead in a circle.
std::filesystem::path behind_links(std::filesystem::path path);

/// The absolute path of the file or folder that a path means to the system: folders' links are resolved
/// before a ".." after them, links at the end are followed, even one to nothing yet, and a "/" at the end
/// says nothing. Throws as behind_links().
std::filesystem::path place_of(const std::filesystem::path& path);

/// An absolute path as short as it can be told: without "." and "..", and with links as they are, but where
/// ".." follows one.
std::filesystem::path absolute_of(const std::filesystem::path& path);

/// Whether two paths mean one file, by links of either kind or by another spelling. Files need not be there.
/// Throws as behind_links().
bool are_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace octotomy::voxel
