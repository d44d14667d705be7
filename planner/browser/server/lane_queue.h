// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

namespace octotomy::planner::serve {

/// Runs tasks one after the other on its own thread. All members may be called from any thread.
class LaneQueue {
 public:
  struct Work {
    std::uint64_t window = 0;
    std::int64_t id = 0;  ///< of the request
    std::function<void(const std::stop_token& stop)> run;
    std::function<void()> dropped;  ///< called instead of `run` if the task was superseded or cancelled
                                    ///< before it started
  };

  /// With `newest_only`, a window's new task drops the window's waiting task and requests its running one to
  /// stop.
  explicit LaneQueue(bool newest_only);
  ~LaneQueue();
  LaneQueue(const LaneQueue&) = delete;
  LaneQueue& operator=(const LaneQueue&) = delete;

  void put(Work work);
  /// Drops a waiting request or requests a running one to stop. Returns whether this queue had the request.
  bool cancel(std::uint64_t window, std::int64_t id);
  /// Drops a closed window's waiting tasks without calling `dropped`, and requests its running one to stop.
  void close_window(std::uint64_t window);

 private:
  void run(const std::stop_token& over);
  /// Drops waiting tasks for which `test` is true, and requests the running task to stop if `test` is true
  /// for it.
  template <typename Test>
  std::deque<Work> take_out(const Test& test);

  bool newest_only_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Work> waiting_;
  struct Running {
    std::uint64_t window = 0;
    std::int64_t id = 0;
    std::stop_source stop;
  };
  std::optional<Running> running_;
  std::jthread thread_;
};

}  // namespace octotomy::planner::serve
