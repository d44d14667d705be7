// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// The value of a formula: numbers, names, + - * / and parentheses, min(a, b, ...), max(a, b, ...), hypot(a,
/// b), abs(a), asin_deg(a). Throws std::runtime_error with the formula, the position and the text expected
/// there; for an unknown name with the nearest one; for a division by zero.
double value_of(std::string_view formula, const std::map<std::string, double>& names);

/// A formula as a sum: the factor of each term, and a constant. A term is a name, or a product, quotient or
/// call that contains names; the key of such a term is its text, which is the same for the same formula.
struct Sum {
  std::map<std::string, double> terms;
  double constant = 0.0;
};
/// Needs no values for the names. Throws std::runtime_error as value_of(), except for unknown names.
Sum sum_of(std::string_view formula);

}  // namespace octotomy::planner
