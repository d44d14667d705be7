// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/stopwatch.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

namespace octotomy::planner {
namespace {

std::mutex mutex;

/// All running stopwatches of the process; the newest is the last.
std::vector<const Stopwatch*>& running() {
  static std::vector<const Stopwatch*> watches;
  return watches;
}

}  // namespace

Stopwatch::Stopwatch(Timings& timings, std::string stage)
    : timings_(timings), stage_(std::move(stage)), start_(std::chrono::steady_clock::now()) {
  const std::lock_guard lock(mutex);
  running().push_back(this);
}

Stopwatch::~Stopwatch() {
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start_;
  timings_[stage_] += spent.count();
  const std::lock_guard lock(mutex);
  std::erase(running(), this);
}

std::optional<RunningStage> newest_stage() {
  const std::lock_guard lock(mutex);
  if (running().empty()) return std::nullopt;
  const Stopwatch& newest = *running().back();
  return RunningStage{newest.stage_, newest.start_};
}

}  // namespace octotomy::planner
