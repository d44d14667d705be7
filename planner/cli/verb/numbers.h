// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

namespace octotomy::planner::cli {

/// The finite number that a text states; none if the whole text is not one.
std::optional<double> parse_number(const std::string& text);

/// `Count` finite numbers separated by commas. None if the text is anything else.
template <std::size_t Count>
std::optional<std::array<double, Count>> parse_numbers(const std::string& text) {
  std::array<double, Count> numbers{};
  const char* at = text.c_str();
  for (std::size_t i = 0; i < Count; ++i) {
    char* end = nullptr;
    numbers[i] = std::strtod(at, &end);
    if (end == at || !std::isfinite(numbers[i]) || *end != (i + 1 < Count ? ',' : '\0')) return std::nullopt;
    at = end + 1;
  }
  return numbers;
}

/// As parse_numbers(), but throws CLI::ValidationError with the option, the text and an example.
template <std::size_t Count>
std::array<double, Count> numbers_of(const std::string& option, const std::string& text,
                                     const std::string& example) {
  if (const auto numbers = parse_numbers<Count>(text)) return *numbers;
  std::string message = "'" + text + "' is not ";
  message.append(std::to_string(Count)).append(" numbers between commas, for example ").append(example);
  throw CLI::ValidationError(option, message);
}

/// Validators of numeric options. CLI11's own ones accept NaN, because every comparison with it is false.
CLI::Validator finite();
CLI::Validator above_zero();
CLI::Validator between(double low, double high);

}  // namespace octotomy::planner::cli
