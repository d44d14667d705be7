// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/file_preparation.h"

#include <chrono>
#include <mutex>
#include <utility>

#include "voxel/space/error.h"

namespace octotomy::planner {

struct FilePreparation::Work {
  std::vector<Action> actions;
  voxel::Universe universe;
  Objects objects;
  std::vector<ScanRecord> scans = {};
  Kept kept = {};
  Timings timings = {};

  std::mutex telling = {};
  std::string doing = {};
  double fraction = 0.0;

  void run(const std::stop_token& stop) {
    const auto tell = [this](const std::string& what, double part) {
      const std::lock_guard lock(telling);
      doing = what;
      fraction = part;
    };
    const AnswerBench bench{.universe = universe,
                            .objects = objects,
                            .scans = scans,
                            .timings = timings,
                            .stop = stop,
                            .report = tell,
                            .kept = kept};
    for (const Action& action : actions) action.operation().prepare_file(action.value(), bench);
  }
};

FilePreparation::FilePreparation(std::vector<Action> actions, const voxel::Universe& universe,
                                 Objects objects, const std::stop_token& stop)
    : work_(new Work{std::move(actions), universe, std::move(objects)}),
      stopped_with_(stop, [this] { stop_.request_stop(); }) {
  std::packaged_task<void()> task([work = work_, asked = stop_.get_token()] { work->run(asked); });
  done_ = task.get_future().share();
  thread_ = std::jthread(std::move(task));
}

void FilePreparation::finish(Kept& kept, Timings& timings, const std::stop_token& stop,
                             const std::function<void(const std::string& doing, double fraction)>& progress) {
  using namespace std::chrono_literals;
  while (done_.wait_for(20ms) != std::future_status::ready) {
    if (stop.stop_requested()) stop_.request_stop();
    if (!progress) continue;
    const std::lock_guard lock(work_->telling);
    if (!work_->doing.empty()) progress(work_->doing, work_->fraction);
  }
  done_.get();
  if (stop.stop_requested()) throw voxel::Stopped("stopped before a file was written");
  for (const auto& [key, value] : work_->kept) kept.emplace(key, value);
  for (const auto& [stage, ms] : std::exchange(work_->timings, {})) timings[stage] += ms;
}

}  // namespace octotomy::planner
