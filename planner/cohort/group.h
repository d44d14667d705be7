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
  /// Folder of the same cohort's derivatives by another observer, with which the numbers are compared.
  std::optional<std::filesystem::path> against;
  std::vector<std::string> findings = {};  ///< findings on the cohort as a whole, listed before those of
                                           ///< subjects
};

/// Merges the subjects' answers into out/group: measurements.csv (long), wide.csv, subjects.csv (all
/// subjects; for those without an answer, the reason), summary.json, plots/*.svg, and index.html with the
/// pictures of all subjects. A subject whose audits have a FAIL is merged as doubtful: each table and the
/// page mark it, and each number's summary lists the doubtful subjects and its spread without them. A subject
/// with a file that was changed after it was written is not merged. Returns summary.json. Its findings list
/// every FAIL, one WARN for each check with the number of further ones, and the changed subjects. Cost:
/// linear; memory about 100 bytes per number. Throws voxel::Error, Input or Resource, and Stopped; the group
/// of an earlier run then stays as it is.
nlohmann::ordered_json merge_group(const std::vector<Subject>& subjects, const std::filesystem::path& out,
                                   const GroupOptions& options = {});

/// A table with a row for each subject, and for each number columns with its value, half-width and verdict.
std::string wide_table(const std::vector<std::string>& labels, const CohortTable& table);

}  // namespace octotomy::planner
