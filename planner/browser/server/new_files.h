// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/staged_files.h"

namespace octotomy::planner::serve {

/// Files for a folder that is made only once they are whole: work that ends before leaves neither. Until then
/// they lie in a hidden folder beside the outermost folder that is missing.
class NewFiles {
 public:
  /// Throws voxel::Error, Input or Resource, where nothing can be written there.
  explicit NewFiles(const std::filesystem::path& folder);

  /// Where files and folders are written, under their own names.
  const std::filesystem::path& hidden() const { return staged_.folder(); }
  /// Makes the folder and moves all into it, `last` at the end. Throws voxel::Error, Input, where one of the
  /// names is taken; then none is moved.
  void commit(const std::filesystem::path& last);

 private:
  std::filesystem::path folder_;
  voxel::StagedFiles staged_;
};

}  // namespace octotomy::planner::serve
