// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "tbb/global_control.h"

namespace tbb {

/// A thread for each task; with one thread they run where they are waited for.
class task_group {
 public:
  task_group() = default;
  task_group(const task_group&) = delete;
  task_group& operator=(const task_group&) = delete;

  template <typename Task>
  void run(Task task) {
    if (global_control::most() < 2)
      waiting_.emplace_back(std::move(task));
    else
      threads_.emplace_back([this, task = std::move(task)] { call(task); });
  }
  void wait() {
    for (std::thread& thread : std::exchange(threads_, {})) thread.join();
    for (const std::function<void()>& task : std::exchange(waiting_, {})) call(task);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }

 private:
  template <typename Task>
  void call(const Task& task) {
    try {
      task();
    } catch (...) {
      const std::lock_guard lock(guard_);
      if (!thrown_) thrown_ = std::current_exception();
    }
  }

  std::vector<std::thread> threads_;
  std::vector<std::function<void()>> waiting_;
  std::mutex guard_;
  std::exception_ptr thrown_;
};

}  // namespace tbb
