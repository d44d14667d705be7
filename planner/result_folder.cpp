// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result_folder.h"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

fs::path without_trailing_slash(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

/// A name beside `path` that no other process of this machine makes.
fs::path beside(const fs::path& path, const std::string& suffix) {
  return path.parent_path() / (path.filename().string() + "." + suffix + std::to_string(::getpid()));
}

}  // namespace

ResultFolder::ResultFolder(const fs::path& final_path)
    : final_(without_trailing_slash(final_path)), partial_(beside(final_, "partial")) {
  if (fs::exists(final_) && !fs::is_directory(final_))
    throw std::runtime_error(final_path.string() + ": is a file, a result needs a folder: choose another -o");
  if (fs::exists(final_) && !fs::is_empty(final_) && !fs::exists(final_ / "result.json"))
    throw std::runtime_error(
        final_path.string() +
        ": holds files that are not an earlier result (no result.json): choose another -o");
  fs::remove_all(partial_);
  fs::create_directories(partial_);
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;
  if (!published_) fs::remove_all(partial_, ignored);
}

void ResultFolder::publish() {
  const fs::path old = beside(final_, "old");
  const bool replaces = fs::exists(final_);
  if (replaces) fs::rename(final_, old);
  try {
    fs::rename(partial_, final_);
  } catch (...) {
    std::error_code ignored;
    if (replaces) fs::rename(old, final_, ignored);
    throw;
  }
  published_ = true;
  if (replaces) fs::remove_all(old);
}

void write_text(const fs::path& path, const std::string& text) {
  const auto fail = [&] {
    throw fs::filesystem_error("cannot write", path, std::error_code(errno, std::generic_category()));
  };
  errno = 0;
  std::FILE* opened = std::fopen(path.c_str(), "wb");
  if (opened == nullptr) fail();
  const bool written = std::fwrite(text.data(), 1, text.size(), opened) == text.size();
  const bool closed = std::fclose(opened) == 0;
  if (!written || !closed) fail();
}

}  // namespace octotomy::planner
