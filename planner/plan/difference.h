// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A value that differs between two plans: a field, with its value in both. Null if a plan does not state it.
struct FieldChange {
  std::string field;  ///< its path: "rotate, degrees", "regions[0], view"
  nlohmann::ordered_json from, to;
};
struct StepChange {
  std::string id;
  std::vector<FieldChange> fields;
};

/// The differences between two plans. A value that states the default differs from an omitted one.
struct PlanDifference {
  std::vector<FieldChange> document;  ///< differences in name, scans and universe
  std::vector<std::string> added, removed;
  std::vector<StepChange> changed;
  std::vector<std::string> reordered;  ///< ids of common steps that follow another common step

  bool is_empty() const {
    return document.empty() && added.empty() && removed.empty() && changed.empty() && reordered.empty();
  }
};
PlanDifference difference(const Plan& from, const Plan& to);

nlohmann::ordered_json to_json(const PlanDifference& difference);
/// The differences as text, one per line, such as "+ step 'overlap'" or "~ step 'advanced', translate_mm:
/// [0,-6,2] -> [0,-7,2]".
std::string text_of(const PlanDifference& difference);

}  // namespace octotomy::planner
