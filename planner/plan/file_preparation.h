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

/// Prepares files of a plan's result on a thread of its own, started as soon as the files' objects exist, in
/// parallel with their certificates. The destructor stops the work and waits for it.
class FilePreparation {
 public:
  using Kept = std::map<std::string, std::shared_ptr<const void>>;

  /// Runs the actions in order. Each may leave values in `kept` for the next. `objects` are those made so
  /// far, including those of the actions. Precondition: the operations have a `prepare_file` function.
  FilePreparation(std::vector<Action> actions, const voxel::Universe& universe, Objects objects,
                  const std::stop_token& stop);

  ~FilePreparation() { stop_.request_stop(); }
  FilePreparation(const FilePreparation&) = delete;
  FilePreparation& operator=(const FilePreparation&) = delete;

  /// Waits for the work and reports its progress to `progress`, which may be empty. Adds the values in `kept`
  /// for writing and, at the first call, the time to `timings`. Rethrows exceptions of the work; throws
  /// Stopped if `stop` or the constructor's token requests it. Only one thread may call it at a time.
  void finish(Kept& kept, Timings& timings, const std::stop_token& stop,
              const std::function<void(const std::string& doing, double fraction)>& progress);

 private:
  struct Work;
  std::shared_ptr<Work> work_;
  std::stop_source stop_;
  std::stop_callback<std::function<void()>> stopped_with_;
  std::shared_future<void> done_;
  std::jthread thread_;  ///< last member, so that it ends before the others are destroyed
};

}  // namespace octotomy::planner
