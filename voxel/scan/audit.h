// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "voxel/space/printed.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The first `most` names, and the number of the others.
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
