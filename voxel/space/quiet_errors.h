// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <mutex>

namespace octotomy::voxel {

/// While one lives, what anybody writes to standard error is thrown away: for calls into libraries that print
/// what they also report, where the program owes people one line. One at a time in the process; the others
/// wait. Nothing is thrown: where standard error cannot be turned aside, it stays.
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
