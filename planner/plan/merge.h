// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// A value that both plans changed, and changed differently. Null if a plan does not state it.
struct MergeConflict {
  std::string step;   ///< empty: outside the steps
  std::string field;  ///< empty if the conflict concerns the whole step
  nlohmann::ordered_json base, a, b;

  /// The conflict as a sentence, such as "step 'advanced', translate_mm: [0,-6,2] became [0,-7,2] in A and
  /// [0,-5,2] in B".
  std::string text() const;
};

struct Merged {
  std::string text;  ///< JSON of the merged plan; empty if there are conflicts
  std::vector<MergeConflict> conflicts;
};

/// Merges the changes that two plans make to a common base: changed fields of steps, added and removed steps,
/// and a changed order. A list counts as a single value. Throws std::runtime_error, which names step and
/// field, if there is no conflict but the merged plan is invalid, for example because one plan removes a step
/// that the other one now uses.
Merged merge(const Plan& base, const Plan& a, const Plan& b);

}  // namespace octotomy::planner
