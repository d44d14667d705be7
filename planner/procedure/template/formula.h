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

/// A formula as a sum of terms: factors by what they multiply, and a constant. A name is a term. So is all that is no sum,
/// such as a product of two names or a call; it is called by a text that is the same for the same formula.
struct Sum {
  std::map<std::string, double> terms;
  double constant = 0.0;
};
/// Needs no values of names. Throws std::runtime_error as value_of(), except for unknown names.
Sum sum_of(std::string_view formula);

}  // namespace octotomy::planner
