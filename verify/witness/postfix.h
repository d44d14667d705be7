// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octotomy::verify {

/// Returns the names and operators of an expression in postfix order. Operators are | ^ & - ~, listed from
/// the weakest binding. Throws std::invalid_argument if the text is no expression.
std::vector<std::string> postfix(std::string_view text);

}  // namespace octotomy::verify
