// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/ahead.h"

#include <cassert>
#include <chrono>
#include <utility>

#include "voxel/space/error.h"

namespace octotomy::planner {

struct Ahead::Work {
  Action action;
  voxel::Universe universe;
  Objects objects;
  std::vector<ScanRecord> scans = {};
  Kept kept = {};
  Timings timings = {};

  void run(const std::stop_token& stop) {
    action.operation().ahead(action.value(), {.universe = universe,
                                              .objects = objects,
                                              .scans = scans,
                                              .timings = timings,
                                              .stop = stop,
                                              .kept = kept});
  }
};

Ahead::Ahead(const Action& action, const voxel::Universe& universe, Objects objects,
             const std::stop_token& stop)
    : work_(std::make_shared<Work>(Work{action, universe, std::move(objects)})),
      stopped_with_(stop, [this] { stop_.request_stop(); }) {
  assert(action.operation().ahead);
  std::packaged_task<void()> task([work = work_, asked = stop_.get_token()] { work->run(asked); });
  done_ = task.get_future().share();
  thread_ = std::jthread(std::move(task));
}

void Ahead::finish(Kept& kept, Timings& timings, const std::stop_token& stop) {
  using namespace std::chrono_literals;
  while (done_.wait_for(20ms) != std::future_status::ready)
    if (stop.stop_requested()) stop_.request_stop();
  done_.get();
  if (stop.stop_requested()) throw voxel::Stopped("stopped before a file was written");
  for (const auto& [key, value] : work_->kept) kept.emplace(key, value);
  for (const auto& [stage, ms] : work_->timings) timings[stage] += ms;
}

}  // namespace octotomy::planner
