// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <mutex>

namespace octotomy::voxel {

/// Discards what anybody writes to standard error while one lives: for calls into libraries that print what
/// they also report. One at a time in the process; the others wait. Throws nothing: if standard error cannot
/// be redirected, it stays.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::unique_lock<std::mutex> turn_;
  int kept_ = -1;
};

}  // namespace octotomy::voxel
