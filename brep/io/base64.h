// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace octotomy::brep {

/// The bytes of base64 text, at most so many. Reading ends at the first character that is none of base64's.
std::string from_base64(std::string_view text, std::size_t most);

}  // namespace octotomy::brep
