// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

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

}  // namespace octotomy::voxel
