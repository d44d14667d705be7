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
  bool is_agreed = true;  ///< false: the steps state more than one number, of which this is the most frequent
};

/// The values with which a procedure made a plan's steps, read from the numbers in the steps. A step that was edited states
/// its new number. Values that no step states are left out.
///
/// `planned` holds the plan's steps of the procedure, named as in the procedure's file. Most values are read without the
/// landmarks, which may have been placed again since. `coordinates` returns those of coordinates_of() where a value stands
/// beside a landmark only; then the value is what the steps state about the landmark's present place, and it is agreed
/// only if all steps fit these places. `coordinates` is not called if no value needs it.
std::map<std::string, PlannedValue> planned_values(
    const Procedure& procedure, const nlohmann::ordered_json& planned,
    const std::function<std::map<std::string, double>()>& coordinates);

}  // namespace octotomy::planner
