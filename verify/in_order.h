// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace octotomy::verify {

/// Calls take(i, make(i)) for i from 0 in ascending order, and make() on all threads beforehand, some
/// thousand items at a time: sums that take() adds to have the same bits on any number of threads.
template <typename Item, typename Make, typename Take>
void in_order(std::size_t count, const Make& make, const Take& take) {
  constexpr std::size_t block = std::size_t{1} << 14, grain = 256;
  std::vector<Item> items(std::min(count, block));
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t size = std::min(block, count - first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) items[i] = make(first + i);
                      });
    for (std::size_t i = 0; i < size; ++i) take(first + i, items[i]);
  }
}

}  // namespace octotomy::verify
