// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace octotomy::brep {

/// Decodes base64 text to at most `most` bytes. Reading ends at the first character that is not base64.
std::string from_base64(std::string_view text, std::size_t most);

}  // namespace octotomy::brep
