// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace octotomy::planner {

/// Wall-clock times in milliseconds by stage ("read", "octree", "isosurface", ...). Stages may overlap,
/// because certificates are computed while further objects are made.
using Timings = std::map<std::string, double>;

/// A stage that is running.
struct RunningStage {
  std::string name;
  std::chrono::steady_clock::time_point start;
};

/// Measures a stage: adds the time between its construction and destruction to the timings.
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

/// The stage of this process that was started last and is still running; none between stages.
std::optional<RunningStage> newest_stage();

}  // namespace octotomy::planner
