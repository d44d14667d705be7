// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// A hidden folder beside the files to be written. Files are written into it under their own names and
/// renamed into place together, so that a failure half-way leaves the old ones. Removed with the object.
class StagedFiles {
 public:
  /// Throws Error, Input or Resource, that names `destination` if no folder can be made in it.
  explicit StagedFiles(const std::filesystem::path& destination);
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// Renames every staged file into the destination, `last` (a file name) after all others, so that a header
  /// never appears before its data. Throws Error, Input or Resource, with path and reason.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path destination_;
  std::filesystem::path folder_;
};

}  // namespace octotomy::voxel
