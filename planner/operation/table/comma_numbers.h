// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

// Reads numbers in words of the command line.
namespace octotomy::planner {

/// The finite numbers in a text such as "0,-6,2.5"; empty if the text is anything else.
std::vector<double> comma_numbers(const std::string& text);

/// The finite number in a text; none if the text is anything else.
std::optional<double> number_in(const std::string& text);

}  // namespace octotomy::planner
