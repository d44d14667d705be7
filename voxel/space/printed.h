// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

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

/// The first `most` names, followed by the number of the other names.
inline std::string listed(const std::vector<std::string>& names, std::size_t most = 8) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more" : text;
}

/// "1 slice", "12 slices".
inline std::string slices(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

}  // namespace octotomy::voxel
