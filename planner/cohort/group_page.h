// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace octotomy::planner {

/// One number over a cohort, with its plots.
struct GroupColumn {
  std::string name, unit;
  nlohmann::ordered_json summary;
  std::vector<std::pair<std::string, std::string>> plots;  ///< a kind, and its SVG
  std::vector<std::pair<std::uint32_t, double>> outliers;  ///< subjects and their values
};

struct GroupPage {
  struct Shown {
    std::string label;
    std::string reason;  ///< why there is no answer; empty: there is one
    bool has_picture = false;
    bool is_doubtful = false;  ///< the audit of a scan has a FAIL, but the numbers are used
    std::string audit;         ///< for a doubtful subject: the findings of its scans' audits
  };
  std::vector<Shown> subjects;
  std::vector<GroupColumn> columns;
  std::vector<std::string> findings;  ///< findings on the cohort, as in summary.json
};

/// The page for quality control: subjects without an answer and the reasons, subjects with a FAIL in a scan's
/// audit, all findings, numbers and plots, outliers by label, and all subjects' pictures, which are in the
/// subjects' folders beside the group's.
std::string group_page(const GroupPage& page);

}  // namespace octotomy::planner
