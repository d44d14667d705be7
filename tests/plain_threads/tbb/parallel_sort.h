// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>

namespace tbb {

template <typename Iterator>
void parallel_sort(Iterator first, Iterator last) {
  std::sort(first, last);
}

}  // namespace tbb
