// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "planner/cohort/statistics.h"
#include "planner/cohort/subjects.h"

namespace octotomy::planner {

struct GroupOptions {
  std::stop_token stop;
  std::function<void(const std::string& doing, double fraction)> progress;
  /// The same cohort, measured by another observer: the folder of its derivatives.
  std::optional<std::filesystem::path> against;
  std::vector<std::string> findings = {};  ///< findings on the cohort as a whole, listed before those of
                                           ///< subjects
};

/// Merges the subjects' answers into out/group: measurements.csv (long), wide.csv, subjects.csv (all
/// subjects, with the reason if there is no answer), summary.json, plots/*.svg, and index.html with all
/// subjects' pictures. Subjects whose scans' audits have a FAIL are merged as doubtful: each table and the
/// page mark them, and each number's summary holds their labels and its spread without them. Returns
/// summary.json, whose findings list every such FAIL, each WARN with the number of its subjects, and the
/// subjects with files that were changed after they were written; these are not merged. Cost: linear; memory
/// about 100 bytes per number. Throws voxel::Error, Input or Resource, and Stopped; an earlier group is then
/// unchanged.
nlohmann::ordered_json merge_group(const std::vector<Subject>& subjects, const std::filesystem::path& out,
                                   const GroupOptions& options = {});

/// One row per subject, and columns for each number with its half-width and verdict.
std::string wide_table(const std::vector<std::string>& labels, const CohortTable& table);

}  // namespace octotomy::planner
