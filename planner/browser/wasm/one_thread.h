// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

// Replaces the parts of oneTBB and of the standard library's threads that the voxel kernel uses, for a
// platform with one thread and a library without threads. The build includes it before every source. Loops
// run in order, and a stop is never requested.

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>

#ifndef _LIBCPP_HAS_NO_THREADS
#error "this library has threads: do not include one_thread.h"
#endif

namespace std {  // NOLINT(cert-dcl58-cpp): these names are free where the library has no threads

struct mutex {
  void lock() {}
  void unlock() {}
};
struct stop_token {
  bool stop_requested() const { return false; }
  bool stop_possible() const { return false; }
};
struct thread {
  struct id {
    bool operator==(const id&) const = default;
  };
};
namespace this_thread {
inline thread::id get_id() {
  return {};
}
}  // namespace this_thread

}  // namespace std

namespace tbb {

template <typename Value>
class blocked_range {
 public:
  blocked_range(Value begin, Value end, std::size_t grainsize = 1)
      : begin_(begin), end_(end), grainsize_(grainsize) {}
  Value begin() const { return begin_; }
  Value end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  bool empty() const { return !(begin_ < end_); }
  std::size_t grainsize() const { return grainsize_; }

 private:
  Value begin_, end_;
  std::size_t grainsize_;
};

template <typename Index, typename Body>
void parallel_for(Index begin, Index end, const Body& body) {
  for (Index i = begin; i < end; ++i) body(i);
}
template <typename Value, typename Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  if (!range.empty()) body(range);
}
template <typename Range, typename Value, typename Body, typename Join>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body, const Join&) {
  return range.empty() ? identity : body(range, identity);
}
template <typename Iterator>
void parallel_sort(Iterator first, Iterator last) {
  std::sort(first, last);
}
struct isolated_task_group {
  template <typename Task>
  void run(const Task& task) {
    task();
  }
  void wait() {}
  void cancel() {}
};
template <typename Key, typename Value>
using concurrent_unordered_map = std::unordered_map<Key, Value>;

}  // namespace tbb
