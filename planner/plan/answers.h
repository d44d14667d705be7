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
  /// Called with what is being done and a fraction of it, 0..1.
  std::function<void(const std::string& doing, double fraction)> progress{};
  /// write_files(): a file that cannot be made is not written, with a finding that says why, and the others
  /// are. Else its error ends them all.
  bool keeps_going = false;
};

/// The answers of a plan's measurements, in the order of their steps, each number with its half-width and the
/// terms that make it: sizes of objects by both kernels, gaps between two, distances and angles of points.
nlohmann::ordered_json measurements_json(const Plan& plan, const Evaluation& evaluation);

/// Writes one file of a plan's result below `folder`. Decks of one object share a filling where the calls
/// share `kept`. An object that is empty, has no mesh, or that no mesher can fill is not written; a finding
/// says why. Throws as the writers do where the disk does not take it, and Stopped; then the file is not
/// there. Preconditions: the step makes a file, and `folder` is there.
Exported write_file(const Plan& plan, const Evaluation& evaluation, const Step& step,
                    const std::filesystem::path& folder, Timings& timings,
                    std::map<std::string, std::shared_ptr<const void>>& kept,
                    const ExportOptions& options = {});

/// Writes all files of a plan's result below `folder`, which is there. The time is added to `timings`.
std::vector<Exported> write_files(const Plan& plan, const Evaluation& evaluation,
                                  const std::filesystem::path& folder, Timings& timings,
                                  const ExportOptions& options = {});

}  // namespace octotomy::planner
