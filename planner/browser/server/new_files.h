// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "voxel/space/staged_files.h"

namespace octotomy::planner::serve {

/// The largest size of a file that a page sends, and of all files that it sends into one folder.
inline constexpr std::uint64_t most_upload_bytes = std::uint64_t{4} << 30;

/// Files that appear in a folder only when all are complete. Until then they are in a hidden folder, beside
/// the outermost folder that does not exist yet. If they are never committed, nothing of them remains.
class NewFiles {
 public:
  /// Throws voxel::Error, Input or Resource, if files cannot be written there.
  explicit NewFiles(const std::filesystem::path& folder);

  /// The hidden folder. The caller writes its files and folders here, under their final names.
  const std::filesystem::path& hidden() const { return staged_.folder(); }
  /// Creates the folder and moves all files into it; `last` is moved as the last one. Throws voxel::Error,
  /// Input, and moves none if one of the names is taken.
  void commit(const std::filesystem::path& last);

 private:
  std::filesystem::path folder_;
  voxel::StagedFiles staged_;
};

}  // namespace octotomy::planner::serve
