// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace octotomy::planner {

/// Wall-clock milliseconds by stage ("read", "octree", "isosurface", ...). Stages may overlap: certificates
/// are computed while further objects are made.
using Timings = std::map<std::string, double>;

/// A stage that is still running.
struct RunningStage {
  std::string name;
  std::chrono::steady_clock::time_point start;
};

/// Adds the time between its construction and destruction to a stage.
class Stopwatch {
 public:
  Stopwatch(Timings& timings, std::string stage);
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch();

 private:
  friend std::optional<RunningStage> newest_stage();

  Timings& timings_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
};

/// The current stage of this process: the running one that was started last. None between stages.
std::optional<RunningStage> newest_stage();

}  // namespace octotomy::planner
