// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "voxel/space/staged_files.h"

// The files that one run of a verb writes.
namespace octotomy::planner {

/// Refuses `outs` before the work; empty paths are left out. Throws as need_folder_of() of each, and
/// std::runtime_error where, of several, two mean one file or one means a file of `read`: a single output may
/// replace what it was made of, since its name was typed with that in mind.
void need_outputs(const std::vector<std::filesystem::path>& outs,
                  const std::vector<std::filesystem::path>& read);

/// Refuses an output with a derived name that is the same file as one of `read`. Throws std::runtime_error.
void need_unread(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Refuses a surface's file whose name nobody typed, before the work: throws as need_folder_of() and
/// need_unread(), and std::runtime_error where a link is there, or a file that does not say at its beginning
/// that Octotomy wrote it, as all surfaces that it writes do. A repeated run thus replaces its own files.
void need_untyped_surface(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Writes files beside their places and renames them together: all are there, or none. What is not committed
/// is removed with the object. The data file of a .nhdr or .mhd is treated as voxel::write_scene() does.
class Outputs {
 public:
  /// Calls `write` with the hidden file to write in place of `out`. Throws what it throws, an Error of either
  /// kernel with the name of `out` in place of the hidden one.
  void write(const std::filesystem::path& out,
             const std::function<void(const std::filesystem::path& file)>& write);
  /// Throws as voxel::StagedFiles::commit().
  void commit();

 private:
  voxel::StagedOutputs staged_;
  std::vector<std::filesystem::path> older_samples_;  ///< of headers that are replaced
};

}  // namespace octotomy::planner
