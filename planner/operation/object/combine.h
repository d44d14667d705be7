// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// A Boolean expression of earlier objects.
struct Combine {
  std::string expression;
};

/// Refuses a text that is no expression of earlier objects, with the position of the fault.
void check_expression(const std::string& expression, const Place& place);

}  // namespace octotomy::planner
