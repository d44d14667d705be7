// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace octotomy::voxel {

/// A program to start. A standard stream without a descriptor is /dev/null. Precondition: `out` and `errors`
/// are above 2.
struct Spawn {
  std::vector<std::string> words = {};  ///< the program, found by PATH if it has no slash, and its arguments
  std::optional<int> in = {}, out = {}, errors = {};
  bool has_environment = true;  ///< whether it inherits the environment; if not, it has no variables
  /// Whether it has a separate process group; if not, it receives our terminal's signals.
  bool has_own_group = false;
};

/// Starts the program and returns its process. The program inherits no other open file, no blocked signal,
/// and no ignored signal except SIGHUP, so that under nohup both processes outlive the terminal. Throws
/// std::system_error with the program's name.
pid_t spawn(const Spawn& program);

/// Waits for the end of a child and returns its status as waitpid() reports it. Until then `look`, which may
/// send signals, is called at intervals of `look_every`. Throws std::system_error if `child` is not a child
/// of this process.
int wait_for_end(pid_t child, std::chrono::milliseconds look_every, const std::function<void()>& look);

}  // namespace octotomy::voxel
