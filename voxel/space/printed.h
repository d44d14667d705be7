// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

namespace octotomy::voxel {

/// Formats a text as printf does, cut off after 511 characters.
template <typename... Parts>
std::string print(const char* format, Parts... parts) {
  char text[512];
  std::snprintf(text, sizeof text, format, parts...);
  return text;
}

/// A text from a file for a one-line message: control characters, which would act on a terminal, become '?'.
inline std::string shown(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char symbol) { return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f; }, '?');
  return text;
}

}  // namespace octotomy::voxel
