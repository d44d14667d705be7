// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "planner/cli/verb.h"
#include "voxel/space/scene.h"

// The verbs that draw, segment and prepare scans, and what verbs ask of samples and options alike.
namespace octotomy::planner::cli {

void add_prepare(Program& program);
void add_segment(Program& program);

/// Throws std::runtime_error where the window is a tissue's name, which parse_window() takes too (tissue.h),
/// and the samples are no Hounsfield units.
void need_hounsfield(const std::string& window, const voxel::Scene& scene);

/// #RRGGBB, each part 0 to 1; throws CLI::ValidationError where it is not that.
glm::vec3 parse_colour(const std::string& text);

}  // namespace octotomy::planner::cli
