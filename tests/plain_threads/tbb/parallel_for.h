// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// The part of oneTBB that this project uses, on plain threads. The thread sanitizer recognises the order that
// std::thread and std::atomic impose. In a library that was built without it, it does not, and reports races
// for everything that such a library passes between threads. Iterations run in any order on any thread, as in
// oneTBB; loops within loops run on the thread that meets them.

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "tbb/blocked_range.h"
#include "tbb/global_control.h"

namespace tbb {
namespace plain {

inline thread_local bool within_loop = false;

/// Calls run(i) for every i below count.
inline void loop(std::size_t count, const std::function<void(std::size_t)>& run) {
  const std::size_t threads = std::min<std::size_t>(count, global_control::most());
  if (within_loop || threads < 2) {
    for (std::size_t i = 0; i < count; ++i) run(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex guard;
  const auto work = [&] {
    within_loop = true;
    try {
      for (std::size_t i = next++; i < count; i = next++) run(i);
    } catch (...) {
      const std::lock_guard lock(guard);
      if (!thrown) thrown = std::current_exception();
    }
    within_loop = false;
  };
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (thrown) std::rethrow_exception(thrown);
}

/// The range in parts of its grain size, at most 64.
template <typename Value>
std::vector<blocked_range<Value>> parts(const blocked_range<Value>& range) {
  const std::size_t grain = std::max<std::size_t>({1, range.grainsize(), range.size() / 64});
  std::vector<blocked_range<Value>> all;
  for (std::size_t at = 0; at < range.size(); at += grain)
    all.emplace_back(
        static_cast<Value>(range.begin() + static_cast<Value>(at)),
        static_cast<Value>(range.begin() + static_cast<Value>(std::min(at + grain, range.size()))),
        range.grainsize());
  return all;
}

}  // namespace plain

template <typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (!(first < last)) return;
  plain::loop(static_cast<std::size_t>(last - first),
              [&](std::size_t i) { body(static_cast<Index>(first + static_cast<Index>(i))); });
}

template <typename Value, typename Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  const auto parts = plain::parts(range);
  plain::loop(parts.size(), [&](std::size_t i) { body(parts[i]); });
}
struct simple_partitioner {};
template <typename Value, typename Body>
void parallel_for(const blocked_range<Value>& range, const Body& body, simple_partitioner) {
  parallel_for(range, body);
}

}  // namespace tbb
