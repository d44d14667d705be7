// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "voxel/space/staged_files.h"

// The files that one run of a verb writes.
namespace octotomy::planner {

/// Checks outputs before the work; empty paths are skipped. Throws as need_folder_of() for each. With several
/// outputs, also throws std::runtime_error if two of them are the same file or one is a file of `read`. A
/// single output may replace a file of `read`, because the user typed its name.
void need_outputs(const std::vector<std::filesystem::path>& outs,
                  const std::vector<std::filesystem::path>& read);

/// Throws std::runtime_error if an output with a derived name is the same file as one of `read`.
void need_unread(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Checks before the work that a surface may be written to a generated name. Throws as need_folder_of() and
/// need_unread(), and std::runtime_error if there is a link with that name, or a file that was not written by
/// Octotomy as a surface. A repeated run thus replaces only its earlier files.
void need_untyped_surface(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Writes several files beside their places and then renames them together, so that all of them appear or
/// none. The destructor removes files that were not committed. The data file of a .nhdr or .mhd is treated as
/// in voxel::write_scene().
class Outputs {
 public:
  /// Calls `write` with the path of the hidden file that later becomes `out`. Passes its exceptions on; in an
  /// Error of either kernel, `out` replaces the hidden file's path.
  void write(const std::filesystem::path& out,
             const std::function<void(const std::filesystem::path& file)>& write);
  /// Throws as voxel::StagedFiles::commit().
  void commit();

 private:
  voxel::StagedOutputs staged_;
  std::vector<std::filesystem::path> older_samples_;  ///< sample files of headers that are replaced
};

}  // namespace octotomy::planner
