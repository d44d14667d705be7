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

/// Prepares files of a plan's result on its own thread, in parallel with certificates. It can start when the
/// objects of the files exist. The destructor requests a stop and waits.
class FilePreparation {
 public:
  using Kept = std::map<std::string, std::shared_ptr<const void>>;

  /// Starts the work: runs the actions in order. Each may leave values in `kept` for the next. `objects` are
  /// all objects made so far, including those of the actions. Precondition: the operation of each action has
  /// a `prepare_file` function.
  FilePreparation(std::vector<Action> actions, const voxel::Universe& universe, Objects objects,
                  const std::stop_token& stop);

  ~FilePreparation() { stop_.request_stop(); }
  FilePreparation(const FilePreparation&) = delete;
  FilePreparation& operator=(const FilePreparation&) = delete;

  /// Waits for the work, with its progress in `progress`, which may be empty. Adds the values that writing
  /// the files needs to `kept` and, at the first call, the time to `timings`. Rethrows exceptions of the
  /// work. Throws Stopped if a stop is requested by `stop` or by the constructor's token. May be called by
  /// only one thread at a time.
  void finish(Kept& kept, Timings& timings, const std::stop_token& stop,
              const std::function<void(const std::string& doing, double fraction)>& progress);

 private:
  struct Work;
  std::shared_ptr<Work> work_;
  std::stop_source stop_;
  std::stop_callback<std::function<void()>> stopped_with_;
  std::shared_future<void> done_;
  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace octotomy::planner
