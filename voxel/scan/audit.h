// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// A text in printf's format, of at most 511 characters.
template <typename... Parts>
std::string print(const char* format, Parts... parts) {
  char text[512];
  std::snprintf(text, sizeof text, format, parts...);
  return text;
}

/// The first of the names, and how many there are beyond them.
inline std::string listed(const std::vector<std::string>& names, std::size_t most = 8) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > most ? text + " and " + std::to_string(names.size() - most) + " more" : text;
}

/// "1 slice", "12 slices".
inline std::string slices(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " slice" : " slices");
}

/// The audit's line on a file that names its patient frame or does not.
inline Finding frame_finding(bool is_named) {
  if (is_named) return {"orientation", Verdict::Pass, "the file names its patient frame"};
  return {"orientation", Verdict::Warn,
          "the file names no patient frame: its columns, rows and slices are assumed to run to the patient's "
          "left, back and head; check that left and right are not exchanged"};
}

}  // namespace octotomy::voxel
