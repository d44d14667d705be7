// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>

namespace octotomy::planner {

/// Background tasks on idle threads. With one thread a task runs inside wait(). The destructor stops the
/// tasks and waits for them. Only one thread may call the members at a time.
class Beside {
 public:
  /// `stop` also stops the tasks.
  explicit Beside(const std::stop_token& stop);
  ~Beside();
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;

  /// Starts a task, which must check the token passed to it. Tasks are numbered from 0 and started in order.
  /// Precondition: not called within apart().
  void begin(std::function<void(const std::stop_token&)> piece);
  /// Waits for a task and may run others meanwhile. Rethrows the task's exception.
  void wait(std::size_t piece);
  /// Runs work of the caller. Its parallel loops do not run background tasks while they wait.
  void apart(const std::function<void()>& work) const;

 private:
  struct Pieces;
  std::unique_ptr<Pieces> pieces_;
};

}  // namespace octotomy::planner
