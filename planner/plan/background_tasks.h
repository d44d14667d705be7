// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>

namespace octotomy::planner {

/// Background tasks on idle threads. With one thread, a task runs inside wait(). The destructor requests the
/// tasks to stop and waits for them. Members may be called by only one thread at a time.
class BackgroundTasks {
 public:
  /// A stop that is requested by `stop` also stops the tasks.
  explicit BackgroundTasks(const std::stop_token& stop);
  ~BackgroundTasks();
  BackgroundTasks(const BackgroundTasks&) = delete;
  BackgroundTasks& operator=(const BackgroundTasks&) = delete;

  /// Starts a task. The task must check the token that it receives. Tasks are numbered from 0 in the order of
  /// the calls, in which they also start. Must not be called within without_tasks().
  void begin(std::function<void(const std::stop_token&)> task);
  /// Waits for the task with this number. May run other tasks meanwhile. Rethrows the task's exception.
  void wait(std::size_t task);
  /// Runs work so that its parallel loops start no background task while they wait.
  void without_tasks(const std::function<void()>& work) const;

 private:
  struct Tasks;
  std::unique_ptr<Tasks> tasks_;
};

}  // namespace octotomy::planner
