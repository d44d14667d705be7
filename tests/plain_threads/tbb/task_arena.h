// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "tbb/global_control.h"

namespace tbb::this_task_arena {

inline int max_concurrency() {
  return static_cast<int>(global_control::most());
}

/// A thread of these takes up no work but its own anyway.
template <typename Function>
auto isolate(const Function& function) {
  return function();
}

}  // namespace tbb::this_task_arena
