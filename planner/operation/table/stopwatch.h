// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace octotomy::planner {

/// Wall-clock milliseconds by stage ("read", "octree", "isosurface", ...). Stages may overlap: certificates
/// are made while further objects are.
using Timings = std::map<std::string, double>;

/// A stage that has not ended yet.
struct RunningStage {
  std::string name;
  std::chrono::steady_clock::time_point start;
};

/// Adds the time from its making to its end to a stage.
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

/// What this process does: of the stages that run the one begun last. None between stages.
std::optional<RunningStage> newest_stage();

}  // namespace octotomy::planner
