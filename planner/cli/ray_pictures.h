// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/render_text.h"
#include "planner/cli/verb.h"

namespace octotomy::planner::cli {

/// Shadings that show what lies along rays instead of the first surface: mip, radiograph, composite.
std::vector<std::string> ray_picture_names();
bool is_ray_picture(const RenderText& text);

/// Draws such a picture of one file's samples. What such pictures do not have is refused.
int render_rays(const Program& program, const RenderText& text);

}  // namespace octotomy::planner::cli
