// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace octotomy::tests {

/// Whether a condition becomes true within a minute.
inline bool holds_soon(const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// Runs the work in a new process, which ends when the work has ended.
inline pid_t in_process(const std::function<void()>& work) {
  const pid_t process = ::fork();
  if (process != 0) return process;
  try {
    work();
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);
}

/// While this object exists, processes whose parents end become children of this process, so that it can
/// observe their ends.
class Orphans {
 public:
  Orphans() { ::prctl(PR_SET_CHILD_SUBREAPER, 1); }
  Orphans(const Orphans&) = delete;
  Orphans& operator=(const Orphans&) = delete;
  ~Orphans() {
    while (::waitpid(-1, nullptr, WNOHANG) >= 0) kill_children();
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  }

  /// Whether no child is left within a minute, though nobody ends them.
  bool end_by_themselves() const {
    return holds_soon([] {
      while (::waitpid(-1, nullptr, WNOHANG) > 0) continue;
      return ::waitpid(-1, nullptr, WNOHANG) < 0;
    });
  }

 private:
  static void kill_children() {
    std::ifstream children("/proc/thread-self/children");
    for (pid_t child = 0; children >> child;) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
};

}  // namespace octotomy::tests
