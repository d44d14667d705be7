// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "tbb/global_control.h"

namespace tbb {

/// An arena of the requested number of threads; the limit holds for the whole program.
class task_arena {
 public:
  explicit task_arena(int threads) : threads_(static_cast<std::size_t>(threads)) {}

  template <typename Function>
  auto execute(const Function& function) {
    const global_control limit(global_control::max_allowed_parallelism, threads_);
    return function();
  }

 private:
  std::size_t threads_;
};

namespace this_task_arena {

inline int max_concurrency() {
  return static_cast<int>(global_control::most());
}

/// These threads never work on other tasks anyway, so the function is simply called.
template <typename Function>
auto isolate(const Function& function) {
  return function();
}

}  // namespace this_task_arena
}  // namespace tbb
