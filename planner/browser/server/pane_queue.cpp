// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/pane_queue.h"

#include <algorithm>
#include <utility>

namespace octotomy::planner::serve {

template <typename Test>
bool PaneQueue::stop_if(const Test& test) {
  const bool stops = drawn_ && test(*drawn_);
  if (stops) drawn_->stop.request_stop();
  return stops;
}

void PaneQueue::ask(PaneRequest asked) {
  const std::lock_guard lock(mutex_);
  stop_if(
      [&](const Drawn& drawn) { return drawn.name == asked.name && !(drawn.is_moving && asked.is_moving); });
  Pane& pane = panes_[asked.name];
  pane.waiting = std::move(asked);
  changed_.notify_all();
}

std::optional<PaneQueue::PaneRequest> PaneQueue::withdraw(const PaneName& name) {
  const std::lock_guard lock(mutex_);
  const auto pane = panes_.find(name);
  return pane == panes_.end() ? std::nullopt : std::exchange(pane->second.waiting, std::nullopt);
}

std::optional<PaneQueue::PaneRequest> PaneQueue::withdraw(std::uint64_t window, std::int64_t id) {
  const std::lock_guard lock(mutex_);
  for (auto& [name, pane] : panes_)
    if (name.window == window && pane.waiting && pane.waiting->request.id == id)
      return std::exchange(pane.waiting, std::nullopt);
  return {};
}

bool PaneQueue::stop(std::uint64_t window, std::int64_t id) {
  const std::lock_guard lock(mutex_);
  return stop_if([&](const Drawn& drawn) { return drawn.name.window == window && drawn.id == id; });
}

std::map<PaneName, PaneQueue::Pane>::iterator PaneQueue::ready() {
  auto chosen = panes_.end();
  for (auto pane = panes_.begin(); pane != panes_.end(); ++pane) {
    const Pane& each = pane->second;
    const bool is_free = each.waiting && (!each.waiting->is_moving || each.in_flight.size() < most_in_flight);
    if (is_free && (chosen == panes_.end() || each.served < chosen->second.served)) chosen = pane;
  }
  return chosen;
}

std::optional<PaneQueue::PaneRequest> PaneQueue::next(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  drawn_.reset();
  if (!changed_.wait(lock, stop, [this] { return ready() != panes_.end(); })) return {};
  Pane& pane = ready()->second;
  pane.served = ++turn_;
  PaneRequest asked = *std::exchange(pane.waiting, std::nullopt);
  if (asked.is_moving) pane.in_flight.insert(asked.request.id);
  drawn_ = Drawn{asked.name, asked.request.id, asked.is_moving, asked.stop};
  return asked;
}

void PaneQueue::shown(const PaneName& name, std::int64_t frame) {
  const std::lock_guard lock(mutex_);
  const auto pane = panes_.find(name);
  if (pane == panes_.end()) return;
  // The page shows frames in order. Once it has shown this one, none of the earlier frames is pending.
  pane->second.in_flight.erase(pane->second.in_flight.begin(), pane->second.in_flight.upper_bound(frame));
  changed_.notify_all();
}

int PaneQueue::moving_panes() const {
  const std::lock_guard lock(mutex_);
  const auto count = std::count_if(panes_.begin(), panes_.end(), [](const auto& pane) {
    return !pane.second.in_flight.empty() || (pane.second.waiting && pane.second.waiting->is_moving);
  });
  return std::max(1, static_cast<int>(count));
}

std::optional<PaneQueue::PaneRequest> PaneQueue::close(const PaneName& name) {
  const std::lock_guard lock(mutex_);
  stop_if([&](const Drawn& drawn) { return drawn.name == name; });
  const auto pane = panes_.find(name);
  if (pane == panes_.end()) return {};
  std::optional<PaneRequest> waited = std::move(pane->second.waiting);
  panes_.erase(pane);
  return waited;
}

void PaneQueue::close_window(std::uint64_t window) {
  const std::lock_guard lock(mutex_);
  stop_if([&](const Drawn& drawn) { return drawn.name.window == window; });
  std::erase_if(panes_, [window](const auto& pane) { return pane.first.window == window; });
}

}  // namespace octotomy::planner::serve
