// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A value in which two plans differ. It is null if a plan does not have it.
struct FieldChange {
  std::string field;  ///< its path: "rotate, degrees", "regions[0], view"
  nlohmann::ordered_json from, to;
};
struct StepChange {
  std::string id;
  std::vector<FieldChange> fields;
};

/// The differences between two plans. A stated default and an omitted one count as different.
struct PlanDifference {
  std::vector<FieldChange> document;  ///< changes of name, scans, universe
  std::vector<std::string> added, removed;
  std::vector<StepChange> changed;
  std::vector<std::string> reordered;  ///< steps of both plans that follow a different common step than
                                       ///< before

  bool is_empty() const {
    return document.empty() && added.empty() && removed.empty() && changed.empty() && reordered.empty();
  }
};
PlanDifference difference(const Plan& from, const Plan& to);

nlohmann::ordered_json to_json(const PlanDifference& difference);
/// A line for each: "+ step 'overlap'", "~ step 'advanced', translate_mm: [0,-6,2] -> [0,-7,2]".
std::string text_of(const PlanDifference& difference);

}  // namespace octotomy::planner
