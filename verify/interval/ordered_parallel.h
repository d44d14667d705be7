// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <vector>

namespace octotomy::verify {

/// Computes items in parallel and passes them on in order. Calls make(first, end, items) for runs of any
/// length, on all threads; make() must set every item of its run, because the memory of items is reused.
/// Calls take(i, item) for i from 0 in ascending order, one call at a time, so that sums in take() have the
/// same bits on any number of threads. make() runs at the same time as take() for earlier items, so make()
/// must not read data that take() writes.
template <typename Item, typename Make, typename Take>
void ordered_parallel_by_batch(std::size_t count, const Make& make, const Take& take) {
  constexpr std::size_t block = std::size_t{1} << 14, grain = 256;
  std::array<std::vector<Item>, 2> items;
  items.fill(std::vector<Item>(std::min(count, block)));
  std::vector<Item>*made = &items[0], *taken = &items[1];
  const auto make_from = [&](std::size_t first) {
    if (first >= count) return;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, std::min(count, first + block), grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        make(range.begin(), range.end(), made->data() + (range.begin() - first));
                      });
  };
  make_from(0);
  for (std::size_t first = 0; first < count; first += block) {
    std::swap(made, taken);
    tbb::parallel_invoke([&] { make_from(first + block); },
                         [&] {
                           for (std::size_t i = first; i < std::min(count, first + block); ++i)
                             take(i, (*taken)[i - first]);
                         });
  }
}

/// As ordered_parallel_by_batch(), but make(i) computes the single item i.
template <typename Item, typename Make, typename Take>
void ordered_parallel(std::size_t count, const Make& make, const Take& take) {
  ordered_parallel_by_batch<Item>(
      count,
      [&](std::size_t first, std::size_t end, Item* items) {
        for (std::size_t i = first; i != end; ++i) *items++ = make(i);
      },
      take);
}

}  // namespace octotomy::verify
