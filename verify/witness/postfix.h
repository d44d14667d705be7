// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace octotomy::verify {

/// Names and operators of an expression in postfix order. Operators are | ^ & - ~, listed from the weakest
/// binding. Throws std::invalid_argument for any other text.
std::vector<std::string> postfix(std::string_view text);

}  // namespace octotomy::verify
