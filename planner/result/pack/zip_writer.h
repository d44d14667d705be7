// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// Writes a zip archive. Its bytes depend only on the names, contents and order of the entries: each entry
/// has the date 1980-01-01 and no attributes.
class ZipWriter {
 public:
  /// Creates the file. Throws voxel::Error (Resource), which names the file, if it cannot be created.
  explicit ZipWriter(const std::filesystem::path& path);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Adds a compressed entry. Throws voxel::Error (Resource) if the disk is full.
  void add(const std::string& name, std::string_view bytes);
  /// Completes the archive. Must be called once, after the last entry. Throws as add() does.
  void close();

 private:
  [[noreturn]] void refuse() const;

  std::filesystem::path path_;
  void* zip_;
};

}  // namespace octotomy::planner
