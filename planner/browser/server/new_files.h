// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "voxel/space/staged_files.h"

namespace octotomy::planner::serve {

/// The largest file that a page may send, and the most that it sends in one folder.
inline constexpr std::uint64_t most_upload_bytes = std::uint64_t{4} << 30;

/// Files for a folder that is created only when all are complete; if the work ends earlier, neither exists.
/// Until then they are in a hidden folder beside the outermost missing folder.
class NewFiles {
 public:
  /// Throws voxel::Error, Input or Resource, if nothing can be written there.
  explicit NewFiles(const std::filesystem::path& folder);

  /// The folder into which files and folders are written, under their own names.
  const std::filesystem::path& hidden() const { return staged_.folder(); }
  /// Creates the folder and moves all files into it, `last` at the end. Throws voxel::Error, Input, if one of
  /// the names is taken; then none is moved.
  void commit(const std::filesystem::path& last);

 private:
  std::filesystem::path folder_;
  voxel::StagedFiles staged_;
};

}  // namespace octotomy::planner::serve
