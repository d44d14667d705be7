// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace octotomy::planner {

/// One number over a cohort, as the page shows it.
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
    bool is_doubtful = false;  ///< the audit of a scan has a FAIL, and the numbers count all the same
    std::string audit;         ///< of a doubtful one: what its scans' audits say
  };
  std::vector<Shown> subjects;
  std::vector<GroupColumn> columns;
  std::vector<std::string> findings;  ///< of the cohort, as summary.json has them
};

/// The cohort for quality control: who has no answer and why, whose scans' audits have a FAIL, all findings,
/// numbers and plots, outliers by name, and
/// everyone's picture, which lies in the subject's folder beside the group's.
std::string group_page(const GroupPage& page);

}  // namespace octotomy::planner
