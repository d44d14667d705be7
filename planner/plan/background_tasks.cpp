// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/background_tasks.h"

#include <deque>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <utility>

namespace octotomy::planner {

struct BackgroundTasks::Tasks {
  explicit Tasks(const std::stop_token& asked) : with(asked, [this] { stop.request_stop(); }) {}

  std::stop_source stop;
  std::stop_callback<std::function<void()>> with;
  std::deque<tbb::task_group> groups;  ///< a group for each task, so that each task can be awaited separately
};

BackgroundTasks::BackgroundTasks(const std::stop_token& stop) : tasks_(std::make_unique<Tasks>(stop)) {}

BackgroundTasks::~BackgroundTasks() {
  tasks_->stop.request_stop();
  // The tasks stop by their token. Cancelling a group would make TBB skip parts of loops within a task, which
  // would then continue with incomplete results.
  for (tbb::task_group& group : tasks_->groups) {
    try {
      group.wait();
    } catch (...) {
      // The exception is ignored, because no caller waits for the task any more.
    }
  }
}

void BackgroundTasks::begin(std::function<void(const std::stop_token&)> task) {
  tasks_->groups.emplace_back().run([task = std::move(task), stop = tasks_->stop.get_token()] {
    // Isolated: otherwise a thread that waits within this task could start another task, which would have to
    // end first.
    tbb::this_task_arena::isolate([&] { task(stop); });
  });
}

void BackgroundTasks::wait(std::size_t task) {
  tasks_->groups.at(task).wait();
}

void BackgroundTasks::without_tasks(const std::function<void()>& work) const {
  tbb::this_task_arena::isolate([&] { work(); });
}

}  // namespace octotomy::planner
