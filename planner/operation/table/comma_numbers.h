// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

// Numbers in the words of the command line.
namespace octotomy::planner {

/// The finite numbers between commas: "0,-6,2.5". Empty if the text is anything else.
std::vector<double> comma_numbers(const std::string& text);

/// The finite number that the text is; none if it is anything else.
std::optional<double> number_in(const std::string& text);

}  // namespace octotomy::planner
