// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/lane_queue.h"

#include <algorithm>
#include <utility>

namespace octotomy::planner::serve {

LaneQueue::LaneQueue(bool newest_only)
    : newest_only_(newest_only), thread_([this](const std::stop_token& over) { run(over); }) {}

LaneQueue::~LaneQueue() {
  {
    const std::lock_guard lock(mutex_);
    take_out([](std::uint64_t, std::int64_t) { return true; });
  }
  thread_.request_stop();
}

template <typename Test>
std::deque<LaneQueue::Work> LaneQueue::take_out(const Test& test) {
  std::deque<Work> out;
  if (running_ && test(running_->window, running_->id)) running_->stop.request_stop();
  std::erase_if(waiting_, [&](Work& work) {
    const bool goes = test(work.window, work.id);
    if (goes) out.push_back(std::move(work));
    return goes;
  });
  return out;
}

void LaneQueue::put(Work work) {
  std::deque<Work> superseded;
  {
    const std::lock_guard lock(mutex_);
    if (newest_only_)
      superseded =
          take_out([mine = work.window](std::uint64_t window, std::int64_t) { return window == mine; });
    waiting_.push_back(std::move(work));
    changed_.notify_all();
  }
  for (const Work& each : superseded) each.dropped();
}

bool LaneQueue::cancel(std::uint64_t window, std::int64_t id) {
  bool is_here = false;
  std::deque<Work> cancelled;
  {
    const std::lock_guard lock(mutex_);
    is_here = running_ && running_->window == window && running_->id == id;
    cancelled = take_out([&](std::uint64_t w, std::int64_t i) { return w == window && i == id; });
  }
  for (const Work& each : cancelled) each.dropped();
  return is_here || !cancelled.empty();
}

void LaneQueue::close_window(std::uint64_t window) {
  const std::lock_guard lock(mutex_);
  take_out([&](std::uint64_t w, std::int64_t) { return w == window; });
}

void LaneQueue::run(const std::stop_token& over) {
  while (true) {
    std::function<void(const std::stop_token&)> work;
    std::stop_token stop;
    {
      std::unique_lock lock(mutex_);
      running_.reset();
      if (!changed_.wait(lock, over, [this] { return !waiting_.empty(); })) return;
      Work next = std::move(waiting_.front());
      waiting_.pop_front();
      running_.emplace(Running{next.window, next.id, {}});
      stop = running_->stop.get_token();
      work = std::move(next.run);
    }
    work(stop);
  }
}

}  // namespace octotomy::planner::serve
