// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::planner {

/// A folder that appears whole or not at all: it is filled beside its place and renamed into it.
class ResultFolder {
 public:
  /// Throws std::runtime_error where `final_path` is a file, or a folder that holds something and no
  /// result.json, so that nothing but an earlier result is ever replaced; and where nothing can be made
  /// there.
  explicit ResultFolder(const std::filesystem::path& final_path);
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;
  /// Removes what was written, unless it was published.
  ~ResultFolder();

  /// Where files are written until publish(); exists.
  const std::filesystem::path& path() const { return partial_; }
  /// Puts the folder in its place; an earlier result there goes only after the new one is complete.
  /// Throws std::filesystem::filesystem_error.
  void publish();

 private:
  std::filesystem::path final_, partial_;
  bool published_ = false;
};

/// Writes text as a file. Throws std::filesystem::filesystem_error with path and the system's reason.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace octotomy::planner
