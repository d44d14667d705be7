// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "tbb/global_control.h"

namespace tbb {

/// Tasks that begin on other threads at once, if there may be any; the thread that waits takes up the rest.
class isolated_task_group {
 public:
  isolated_task_group() = default;
  isolated_task_group(const isolated_task_group&) = delete;
  isolated_task_group& operator=(const isolated_task_group&) = delete;
  ~isolated_task_group() {
    cancel();
    join();
  }

  void run(std::function<void()> task) {
    const std::lock_guard lock(guard_);
    tasks_.push_back(std::move(task));
    if (at_work_ + 1 >= global_control::most()) return;
    ++at_work_;
    threads_.emplace_back([this] {
      work();
      const std::lock_guard done(guard_);
      --at_work_;
    });
  }
  void wait() {
    work();
    join();
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }
  void cancel() {
    const std::lock_guard lock(guard_);
    tasks_.clear();
  }

 private:
  void work() {
    std::unique_lock lock(guard_);
    while (!tasks_.empty()) {
      const std::function<void()> task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      std::exception_ptr thrown;
      try {
        task();
      } catch (...) {
        thrown = std::current_exception();
      }
      lock.lock();
      if (!thrown) continue;
      if (!thrown_) thrown_ = thrown;
      tasks_.clear();
    }
  }
  void join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  std::mutex guard_;
  std::deque<std::function<void()>> tasks_;
  std::size_t at_work_ = 0;
  std::exception_ptr thrown_;
  std::vector<std::thread> threads_;
};
/// A thread that waits takes up no work of others here anyway.
using task_group = isolated_task_group;

}  // namespace tbb
