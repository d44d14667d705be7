// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>

namespace tbb {

class global_control {
 public:
  enum parameter { max_allowed_parallelism };

  global_control(parameter, std::size_t threads) : before_(most().exchange(threads)) {}
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;
  ~global_control() { most() = before_; }

  static std::size_t active_value(parameter) { return most(); }
  /// The number of threads of a loop: a few, so that they meet even on fewer processors.
  static std::atomic<std::size_t>& most() {
    static std::atomic<std::size_t> threads{4};
    return threads;
  }

 private:
  std::size_t before_;
};

}  // namespace tbb
