// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "planner/browser/server/message.h"
#include "voxel/space/view.h"

// What requests for pictures say.
namespace octotomy::planner::serve {

/// The most pixels along a pane's side.
inline constexpr int most_pane_px = 4096;

/// [w, h] of a request's "size". Throws std::runtime_error where it is none, or too large.
glm::ivec2 size_px_of(const Json& said);
/// [x, y, z] of finite numbers; none where the key is missing or null. Throws std::runtime_error.
std::optional<glm::dvec3> point_of(const Json& said, const char* key);
/// A finite number; none where the key is missing or null. Throws std::runtime_error.
std::optional<double> number_of(const Json& said, const char* key);
/// A number as short as it reads back to the same.
std::string exact(double value);

/// {"right", "up", "look", "centre_mm", "pixel_mm"}.
Json view_frame_json(const voxel::View& view, const glm::dvec3& centre_mm, double pixel_mm);

}  // namespace octotomy::planner::serve
