// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

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
  /// folder is not replaced.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path destination_;
  UnfinishedFolder unfinished_;
};

/// The file that a path means: links at its end followed, even one to nothing yet. Throws Error (Input) if
/// the links lead in a circle.
std::filesystem::path behind_links(std::filesystem::path path);

}  // namespace octotomy::voxel
