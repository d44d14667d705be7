// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/numbers.h"

#include <functional>
#include <sstream>

namespace octotomy::planner::cli {
namespace {

CLI::Validator number_that(const std::string& is, const std::function<bool(double)>& holds) {
  return {[is, holds](const std::string& text) -> std::string {
            const std::optional<double> number = parse_number(text);
            return number && holds(*number) ? std::string() : "'" + text + "' is not a number" + is;
          },
          ""};
}

}  // namespace

std::optional<double> parse_number(const std::string& text) {
  const auto number = parse_numbers<1>(text);
  return number ? std::optional((*number)[0]) : std::nullopt;
}

CLI::Validator finite() {
  return number_that("", [](double) { return true; });
}

CLI::Validator above_zero() {
  return number_that(" above 0", [](double number) { return number > 0.0; });
}

CLI::Validator between(double low, double high) {
  std::ostringstream is;
  is << " from " << low << " to " << high;
  return number_that(is.str(), [low, high](double number) { return number >= low && number <= high; });
}

}  // namespace octotomy::planner::cli
