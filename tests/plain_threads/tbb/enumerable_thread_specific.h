// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace tbb {

/// A value for each thread that has requested one.
template <typename Value>
class enumerable_thread_specific {
 public:
  explicit enumerable_thread_specific(Value first = {}) : first_(std::move(first)) {}

  Value& local() {
    const std::lock_guard lock(guard_);
    const std::thread::id self = std::this_thread::get_id();
    for (std::size_t i = 0; i < owners_.size(); ++i)
      if (owners_[i] == self) return values_[i];
    owners_.push_back(self);
    return values_.emplace_back(first_);
  }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  template <typename Join>
  Value combine(const Join& join) {
    Value all = values_.empty() ? first_ : values_.front();
    for (std::size_t i = 1; i < values_.size(); ++i) all = join(all, values_[i]);
    return all;
  }

 private:
  Value first_;
  std::mutex guard_;
  std::deque<std::thread::id> owners_;
  std::deque<Value> values_;
};

}  // namespace tbb
