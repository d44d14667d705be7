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

/// A thread that runs one task after the other. All members may be called from any thread.
class LaneQueue {
 public:
  struct Work {
    std::uint64_t window = 0;
    std::int64_t id = 0;  ///< of the request
    std::function<void(const std::stop_token& stop)> run;
    std::function<void()> dropped;  ///< called instead of `run` if the task was superseded or cancelled
                                    ///< before it started
  };

  /// `newest_only`: a newer task of a window drops the window's waiting task and stops its running one.
  explicit LaneQueue(bool newest_only);
  ~LaneQueue();
  LaneQueue(const LaneQueue&) = delete;
  LaneQueue& operator=(const LaneQueue&) = delete;

  void put(Work work);
  /// Drops or stops a request; returns whether it was in this queue.
  bool cancel(std::uint64_t window, std::int64_t id);
  /// Drops and stops all tasks of a closed window, without calling `dropped`.
  void close_window(std::uint64_t window);

 private:
  void run(const std::stop_token& over);
  /// Removes waiting tasks for which `test` is true, and requests a running one to stop.
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
