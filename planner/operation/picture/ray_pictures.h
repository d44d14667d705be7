// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/picture/render.h"

namespace octotomy::planner {

/// The shadings that show all samples along rays instead of the first surface: mip, radiograph, composite.
std::vector<std::string> ray_picture_names();
bool is_ray_picture(const Render& render);

/// Throws std::runtime_error if options are set that pictures along rays do not have.
void check_rays(const Render& render);

/// The window of the drawn samples; for a composite picture, from the first sample that is visible.
SampleWindow ray_window(const Render& render);

/// Draws a picture along rays of one object's samples. Throws std::runtime_error unless there is exactly one
/// object and it has samples.
RenderedPicture render_rays(const Render& render, const std::vector<voxel::DrawnObject>& objects,
                            Timings& timings, const std::stop_token& stop);

}  // namespace octotomy::planner
