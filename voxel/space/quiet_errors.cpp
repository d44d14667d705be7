// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/quiet_errors.h"

#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

namespace octotomy::voxel {

namespace {

std::mutex& only_turn() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

QuietErrors::QuietErrors() : turn_(only_turn()) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  std::fflush(stderr);
  kept_ = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  if (kept_ >= 0) dup2(nowhere, STDERR_FILENO);
  close(nowhere);
}

QuietErrors::~QuietErrors() {
  if (kept_ < 0) return;
  std::fflush(stderr);
  dup2(kept_, STDERR_FILENO);
  close(kept_);
}

}  // namespace octotomy::voxel
