// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "voxel/space/staged_files.h"

// The files that one run of a verb writes.
namespace octotomy::planner {

/// Refuses `outs` before the work; empty paths are left out. Throws as need_folder_of() of each. If there
/// are several, throws std::runtime_error if two are the same file or one is a file of `read`. A single
/// output may replace a file of `read`, because its name was typed with that intention.
void need_outputs(const std::vector<std::filesystem::path>& outs,
                  const std::vector<std::filesystem::path>& read);

/// Refuses an output with a derived name that is the same file as one of `read`. Throws std::runtime_error.
void need_unread(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Refuses a surface's file with a generated name before the work. Throws as need_folder_of() and
/// need_unread(), and std::runtime_error if a link has that name, or a file that does not begin as all
/// surfaces written by Octotomy do. A repeated run thus replaces only its own files.
void need_untyped_surface(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Writes files beside their places and renames them together: all are there, or none. Files that were not
/// committed are removed by the destructor. The data file of a .nhdr or .mhd is treated as in
/// voxel::write_scene().
class Outputs {
 public:
  /// Calls `write` with the hidden file to write in place of `out`. Rethrows its exceptions; in an Error of
  /// either kernel the hidden file's name is replaced by that of `out`.
  void write(const std::filesystem::path& out,
             const std::function<void(const std::filesystem::path& file)>& write);
  /// Throws as voxel::StagedFiles::commit().
  void commit();

 private:
  voxel::StagedOutputs staged_;
  std::vector<std::filesystem::path> older_samples_;  ///< of headers that are replaced
};

}  // namespace octotomy::planner
