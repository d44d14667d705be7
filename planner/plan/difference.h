// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// One value that two plans have differently. A value that one of them has not is null.
struct FieldChange {
  std::string field;  ///< its place: "rotate, degrees", "regions[0], view"
  nlohmann::ordered_json from, to;
};
struct StepChange {
  std::string id;
  std::vector<FieldChange> fields;
};

/// How a plan differs from another one. A default that is said is none that is left out.
struct PlanDifference {
  std::vector<FieldChange> document;  ///< name, scans, universe
  std::vector<std::string> added, removed;
  std::vector<StepChange> changed;
  std::vector<std::string> reordered;  ///< steps of both that come after another one of both than they did

  bool is_empty() const {
    return document.empty() && added.empty() && removed.empty() && changed.empty() && reordered.empty();
  }
};
PlanDifference difference(const Plan& from, const Plan& to);

nlohmann::ordered_json to_json(const PlanDifference& difference);
/// A line for each: "+ step 'overlap'", "~ step 'advanced', translate_mm: [0,-6,2] -> [0,-7,2]".
std::string text_of(const PlanDifference& difference);

}  // namespace octotomy::planner
