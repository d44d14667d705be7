// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/scan_verbs.h"

#include "planner/picture/colour.h"
#include "voxel/filter/tissue.h"

namespace octotomy::planner::cli {

void need_hounsfield(const std::string& window, const voxel::Scene& scene) {
  if (voxel::tissue(window)) planner::need_hounsfield({.tissue = window}, scene);
}

glm::vec3 parse_colour(const std::string& text) {
  try {
    return need_colour(text);
  } catch (const std::runtime_error& error) {
    throw CLI::ValidationError("--colour", error.what());
  }
}

}  // namespace octotomy::planner::cli
