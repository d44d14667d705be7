// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/comma_numbers.h"

#include <cmath>
#include <cstdlib>

namespace octotomy::planner {

std::vector<double> comma_numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const char* at = text.c_str();;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(numbers.back()) || (*end != ',' && *end != '\0')) return {};
    if (*end == '\0') return numbers;
    at = end + 1;
  }
}

std::optional<double> number_in(const std::string& text) {
  const std::vector<double> numbers = comma_numbers(text);
  return numbers.size() == 1 ? std::optional(numbers.front()) : std::nullopt;
}

}  // namespace octotomy::planner
