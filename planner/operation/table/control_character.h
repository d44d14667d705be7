// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

// Rejects control characters in names and texts from files, because they would act on a terminal or break a
// list.
namespace octotomy::planner {

/// Whether a byte is an ASCII control character, such as a line end or tab. Bytes of non-ASCII letters are
/// not.
inline bool is_control(char symbol) {
  return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f;
}

inline bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), is_control);
}

/// Throws std::runtime_error if the text has control characters. `what` names the text in the message, for
/// example "a scan's name".
inline void need_no_control(std::string_view text, const std::string& what) {
  if (has_control(text)) throw std::runtime_error(what + " has control characters: remove them");
}

}  // namespace octotomy::planner
