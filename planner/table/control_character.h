// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string_view>

// Names and texts of files reach terminals and lists, which would obey control characters or break at them.
namespace octotomy::planner {

/// Of ASCII, ends of lines and tabulators included; the bytes of other letters are none.
inline bool is_control(char symbol) {
  return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f;
}

inline bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), is_control);
}

}  // namespace octotomy::planner
