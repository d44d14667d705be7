// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>

namespace octotomy::planner {

/// Background tasks on idle threads. With one thread a task runs inside wait(). The destructor stops the
/// tasks and waits for them. Only one thread may call the members at a time.
class BackgroundTasks {
 public:
  /// `stop` also stops the tasks.
  explicit BackgroundTasks(const std::stop_token& stop);
  ~BackgroundTasks();
  BackgroundTasks(const BackgroundTasks&) = delete;
  BackgroundTasks& operator=(const BackgroundTasks&) = delete;

  /// Starts a task, which must check the token passed to it. Tasks are numbered from 0 and started in order.
  /// Precondition: not called within without_tasks().
  void begin(std::function<void(const std::stop_token&)> task);
  /// Waits for a task and may run others meanwhile. Rethrows the task's exception.
  void wait(std::size_t task);
  /// Runs work of the caller. Its parallel loops do not run background tasks while they wait.
  void without_tasks(const std::function<void()>& work) const;

 private:
  struct Tasks;
  std::unique_ptr<Tasks> tasks_;
};

}  // namespace octotomy::planner
