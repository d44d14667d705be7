// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "planner/browser/server/message.h"
#include "voxel/space/view.h"

// Members of requests for pictures.
namespace octotomy::planner::serve {

/// The most pixels along a pane's side.
inline constexpr int most_pane_px = 4096;

/// [w, h] of a request's "size". Throws std::runtime_error if it is absent, invalid or too large.
glm::ivec2 size_px_of(const Json& said);
/// [x, y, z] of finite numbers; none if the key is missing or null. Throws std::runtime_error for other
/// values.
std::optional<glm::dvec3> point_of(const Json& said, const char* key);
/// A finite number; none if the key is missing or null. Throws std::runtime_error for other values.
std::optional<double> number_of(const Json& said, const char* key);
/// The shortest text that reads back to the same number.
std::string exact(double value);

/// {"right", "up", "look", "centre_mm", "pixel_mm"}.
Json view_frame_json(const voxel::View& view, const glm::dvec3& centre_mm, double pixel_mm);

}  // namespace octotomy::planner::serve
