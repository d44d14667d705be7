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
  /// Called with the current task and the fraction of it that is done, from 0 to 1.
  std::function<void(const std::string& doing, double fraction)> progress{};
  /// For write_files(). True: a file that cannot be made has a finding with the reason, and the others are
  /// written. False: the error is thrown.
  bool keeps_going = false;
};

/// The results of the plan's measurements, in the order of their steps: sizes of objects by both kernels,
/// gaps between objects, distances and angles between points. Each number has its half-width and the
/// half-width's terms.
nlohmann::ordered_json measurements_json(const Plan& plan, const Evaluation& evaluation);

/// Writes the file of one step below `folder`. Calls with the same `kept` share the volume mesh of an object.
/// If the object is empty, has no mesh, or cannot be filled by a mesher, no file is written, and a finding
/// states the reason. Throws as the writers do, and Stopped; the file then does not exist. Preconditions: the
/// step makes a file, and `folder` exists.
Exported write_file(const Plan& plan, const Evaluation& evaluation, const Step& step,
                    const std::filesystem::path& folder, Timings& timings,
                    std::map<std::string, std::shared_ptr<const void>>& kept,
                    const ExportOptions& options = {});

/// Writes all files of a plan's result below `folder`, which must exist. Adds the time to `timings`.
std::vector<Exported> write_files(const Plan& plan, const Evaluation& evaluation,
                                  const std::filesystem::path& folder, Timings& timings,
                                  const ExportOptions& options = {});

}  // namespace octotomy::planner
