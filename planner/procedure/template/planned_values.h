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

/// The values with which a procedure made a plan's steps, read from the numbers in the steps. A step that was
/// edited states its new number. Values that no step states are left out.
///
/// `planned` holds the plan's steps of the procedure, named as in the procedure's file. Most values are read
/// without the landmarks, which may have been placed again since. `coordinates` returns coordinates_of() the
/// plan's landmarks; it is called only if some value occurs in no formula without landmarks. Such a value is
/// computed with the landmarks' present places, and is agreed only if all steps fit these places.
std::map<std::string, PlannedValue> planned_values(
    const Procedure& procedure, const nlohmann::ordered_json& planned,
    const std::function<std::map<std::string, double>()>& coordinates);

}  // namespace octotomy::planner
