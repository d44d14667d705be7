// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace octotomy::planner {

/// Evaluates a formula of numbers, names, + - * /, parentheses, min(a, b, ...), max(a, b, ...), hypot(a, b),
/// abs(a) and asin_deg(a). Throws std::runtime_error with the formula and the position for a division by
/// zero, for an unknown name, with the most similar one, and for an invalid text, with what was expected.
double value_of(std::string_view formula, const std::map<std::string, double>& names);

/// A formula as a sum of terms with factors, and a constant. A term is a name, or a product, quotient or call
/// that contains names. Such a term has its text as key, so that equal texts are one term.
struct Sum {
  std::map<std::string, double> terms;
  double constant = 0.0;
};
/// The sum of a formula, without values for its names. Throws std::runtime_error as value_of() does, except
/// for unknown names.
Sum sum_of(std::string_view formula);

}  // namespace octotomy::planner
