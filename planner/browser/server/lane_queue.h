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

/// A thread that does one piece of work after the other. All members may be called from any thread.
class LaneQueue {
 public:
  struct Work {
    std::uint64_t window = 0;
    std::int64_t id = 0;  ///< of the request
    std::function<void(const std::stop_token& stop)> run;
    std::function<void()> dropped;  ///< called instead of `run` where it was superseded or cancelled before
  };

  /// `newest_only`: a window's newer work drops what of it waits and stops what of it runs.
  explicit LaneQueue(bool newest_only);
  ~LaneQueue();
  LaneQueue(const LaneQueue&) = delete;
  LaneQueue& operator=(const LaneQueue&) = delete;

  void put(Work work);
  /// Drops or stops a request; whether it was here.
  bool cancel(std::uint64_t window, std::int64_t id);
  /// Drops and stops all work of a window that has gone. Nobody is told.
  void close_window(std::uint64_t window);

 private:
  void run(const std::stop_token& over);
  /// Takes waiting work out that passes a test, and asks running work to stop that does.
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
