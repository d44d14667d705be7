// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// Writes a zip archive whose bytes depend only on the names and contents of its entries and their order: every
/// entry has the date 1980-01-01 and no attributes.
class ZipWriter {
 public:
  /// Creates the file. Throws voxel::Error (Resource), which names it, if it cannot be created.
  explicit ZipWriter(const std::filesystem::path& path);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Adds an entry, deflated. Throws voxel::Error (Resource) if the disk is full.
  void add(const std::string& name, std::string_view bytes);
  /// Completes the archive; to be called once, last. Throws as add().
  void close();

 private:
  [[noreturn]] void refuse() const;

  std::filesystem::path path_;
  void* zip_;
};

}  // namespace octotomy::planner
