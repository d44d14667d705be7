// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "planner/procedure/template/procedure.h"

namespace octotomy::planner {

struct PlannedValue {
  double value = 0.0;
  bool is_agreed = true;  ///< false: steps state different numbers; this is the most frequent one
};

/// The values with which a procedure made the steps of a plan, computed from the numbers in the steps. An
/// edited step may yield a new value. Values that no step determines are left out.
///
/// `planned` are the plan's steps of the procedure, under the names in the procedure's file. Most values are
/// computed without landmarks, which may have been placed again since. `coordinates` returns coordinates_of()
/// the plan's landmarks. It is called only if a value has no formula without landmarks. Such a value is
/// computed with the present landmarks, and is agreed only if all steps fit them.
std::map<std::string, PlannedValue> planned_values(
    const Procedure& procedure, const nlohmann::ordered_json& planned,
    const std::function<std::map<std::string, double>()>& coordinates);

}  // namespace octotomy::planner
