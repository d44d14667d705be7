// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

namespace octotomy::voxel {

/// A text in printf's format, of at most 511 characters.
template <typename... Parts>
std::string print(const char* format, Parts... parts) {
  char text[512];
  std::snprintf(text, sizeof text, format, parts...);
  return text;
}

/// A text out of a file, for a message of one line: control characters, which terminals obey, become '?'.
inline std::string shown(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char symbol) { return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f; }, '?');
  return text;
}

}  // namespace octotomy::voxel
