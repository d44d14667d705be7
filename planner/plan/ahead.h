// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "planner/operation/table/operation.h"

namespace octotomy::planner {

/// Work on files of a plan's result, begun on a thread of its own as soon as the files' objects are made, so
/// that it goes on while they are certified. Its end stops the work and waits for that.
class Ahead {
 public:
  using Kept = std::map<std::string, std::shared_ptr<const void>>;

  /// Works for the actions one after the other; what one keeps the next finds. `objects` are those made so
  /// far, the actions' among them. Precondition: the operations work ahead.
  Ahead(std::vector<Action> actions, const voxel::Universe& universe, Objects objects,
        const std::stop_token& stop);

  ~Ahead() { stop_.request_stop(); }
  Ahead(const Ahead&) = delete;
  Ahead& operator=(const Ahead&) = delete;

  /// Waits for the work and tells its progress, which may be empty; adds what it kept for the writing and,
  /// once, its time. Throws what the work threw, and Stopped where `stop` or the constructor's token asks for
  /// it. Not for several threads at once.
  void finish(Kept& kept, Timings& timings, const std::stop_token& stop,
              const std::function<void(const std::string& doing, double fraction)>& progress);

 private:
  struct Work;
  std::shared_ptr<Work> work_;
  std::stop_source stop_;
  std::stop_callback<std::function<void()>> stopped_with_;
  std::shared_future<void> done_;
  std::jthread thread_;  ///< ends before what stands above
};

}  // namespace octotomy::planner
