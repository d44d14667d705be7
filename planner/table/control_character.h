// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
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

/// Throws std::runtime_error of `what`, for example "a scan's name", where its text has such characters.
inline void need_no_control(std::string_view text, const std::string& what) {
  if (has_control(text)) throw std::runtime_error(what + " has control characters: take them out");
}

}  // namespace octotomy::planner
