// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <string>

namespace octotomy::planner {

/// Wall-clock milliseconds by stage ("read", "octree", "isosurface", ...). Stages may overlap: certificates
/// are made while further objects are.
using Timings = std::map<std::string, double>;

/// Adds the time from its making to its end to a stage.
class Stopwatch {
 public:
  Stopwatch(Timings& timings, std::string stage)
      : timings_(timings), stage_(std::move(stage)), start_(std::chrono::steady_clock::now()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() {
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start_;
    timings_[stage_] += spent.count();
  }

 private:
  Timings& timings_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace octotomy::planner
