// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"

namespace octotomy::planner {

struct ExportOptions {
  std::stop_token stop{};
  /// Called with the current task and its fraction done, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress{};
  /// For write_files(): if a file cannot be made, reports the reason as a finding and writes the others.
  /// Otherwise the error ends the whole call.
  bool keeps_going = false;
};

/// The results of a plan's measurements, in the order of their steps: sizes of objects by both kernels, gaps
/// between objects, distances and angles of points. Each number has its half-width and the terms of it.
nlohmann::ordered_json measurements_json(const Plan& plan, const Evaluation& evaluation);

/// Writes one file of a plan's result below `folder`. Decks of one object share a volume mesh if the calls
/// share `kept`. If an object is empty, has no mesh, or no mesher can fill it, the file is not written and a
/// finding states the reason. Throws as the writers do, and Stopped; then the file does not exist.
/// Preconditions: the step makes a file, and `folder` exists.
Exported write_file(const Plan& plan, const Evaluation& evaluation, const Step& step,
                    const std::filesystem::path& folder, Timings& timings,
                    std::map<std::string, std::shared_ptr<const void>>& kept,
                    const ExportOptions& options = {});

/// Writes all files of a plan's result below `folder`, which must exist. The time is added to `timings`.
std::vector<Exported> write_files(const Plan& plan, const Evaluation& evaluation,
                                  const std::filesystem::path& folder, Timings& timings,
                                  const ExportOptions& options = {});

}  // namespace octotomy::planner
