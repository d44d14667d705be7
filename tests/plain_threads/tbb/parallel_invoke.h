// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>

#include "tbb/parallel_for.h"

namespace tbb {

template <typename... Functions>
void parallel_invoke(const Functions&... functions) {
  const std::array<std::function<void()>, sizeof...(Functions)> all{std::ref(functions)...};
  plain::loop(all.size(), [&](std::size_t i) { all[i](); });
}

}  // namespace tbb
