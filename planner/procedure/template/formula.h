// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// The value of a formula: numbers, names, + - * / and parentheses, min(a, b, ...), max(a, b, ...), hypot(a,
/// b), abs(a), asin_deg(a). Throws std::runtime_error with the formula, the position and what was expected;
/// for an unknown name with the nearest one; for a division by zero.
double value_of(std::string_view formula, const std::map<std::string, double>& names);

}  // namespace octotomy::planner
