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

/// Refuses an output whose name nobody typed where it means a file of `read`. Throws std::runtime_error.
void need_unread(const std::filesystem::path& out, const std::vector<std::filesystem::path>& read);

/// Writes files beside their places and renames them together: all are there, or none. What is not committed
/// is removed with the object.
class Outputs {
 public:
  /// Calls `write` with the hidden file to write in place of `out`. Throws what it throws, an Error of either
  /// kernel with the name of `out` in place of the hidden one.
  void write(const std::filesystem::path& out,
             const std::function<void(const std::filesystem::path& file)>& write);
  /// Throws as voxel::StagedFiles::commit().
  void commit() { staged_.commit(); }

 private:
  voxel::StagedOutputs staged_;
};

}  // namespace octotomy::planner
