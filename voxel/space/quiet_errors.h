// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <mutex>

namespace octotomy::voxel {

/// Discards all output to standard error during its lifetime, for calls into libraries that print errors in
/// addition to returning them. Only one object exists at a time in the process; the constructor of another
/// one waits. Throws nothing: if standard error cannot be redirected, it is not changed.
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
