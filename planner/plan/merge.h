// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A value that both plans changed differently; null if a plan does not have it.
struct MergeConflict {
  std::string step;   ///< empty: outside the steps
  std::string field;  ///< empty: the step as a whole
  nlohmann::ordered_json base, a, b;

  /// "step 'advanced', translate_mm: [0,-6,2] became [0,-7,2] in A and [0,-5,2] in B".
  std::string text() const;
};

struct Merged {
  std::string text;  ///< the plan as JSON; empty if there are conflicts
  std::vector<MergeConflict> conflicts;
};

/// Merges the changes that two plans made to a common base: changed fields of steps, added or removed steps,
/// and a changed order. A list counts as a single value. Throws std::runtime_error, which names step and
/// field, if the changes do not conflict but the merged plan is invalid, for example because one plan removes
/// a step that the other now uses.
Merged merge(const Plan& base, const Plan& a, const Plan& b);

}  // namespace octotomy::planner
