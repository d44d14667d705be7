// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A value that both plans changed, each in its own way; null where a plan has it not.
struct MergeConflict {
  std::string step;   ///< empty: beside the steps
  std::string field;  ///< empty: the step as a whole
  nlohmann::ordered_json base, a, b;

  /// "step 'advanced', translate_mm: [0,-6,2] became [0,-7,2] in A and [0,-5,2] in B".
  std::string text() const;
};

struct Merged {
  std::string text;  ///< the plan as JSON; empty where there are conflicts
  std::vector<MergeConflict> conflicts;
};

/// What two plans changed of one that both come from, in one plan: fields of steps that one of them changed,
/// steps that one added or removed, and the order of one. Lists are one value. Throws std::runtime_error
/// where the changes are at peace and yet make no plan together, as one removes a step that the other now
/// uses; the refusal names step and field.
Merged merge(const Plan& base, const Plan& a, const Plan& b);

}  // namespace octotomy::planner
