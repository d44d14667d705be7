// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::voxel {

/// A hidden folder beside the files to be written: they are written into it under their own names and renamed
/// into place together, so that a failure half-way leaves what was there. Removed with the object.
class Staging {
 public:
  /// Throws std::runtime_error naming `destination` where no folder can be made in it.
  explicit Staging(const std::filesystem::path& destination);
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// Renames every staged file into the destination, `last` (a file name) after all others, so that a header
  /// never stands before its data. Throws std::runtime_error with path and reason.
  void commit(const std::filesystem::path& last = {});

 private:
  std::filesystem::path destination_;
  std::filesystem::path folder_;
};

}  // namespace octotomy::voxel
