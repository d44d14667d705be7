// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"
#include "voxel/space/view.h"

// Reads and writes members that several kinds of pictures share in their requests and headers.
namespace octotomy::planner::serve {

/// The largest number of pixels along a pane's side.
inline constexpr int most_pane_px = 4096;

/// A request's "size", [width, height] in pixels. Throws std::runtime_error if it is absent, invalid or
/// larger than most_pane_px.
glm::ivec2 size_px_of(const Json& said);
/// A member [x, y, z] of finite numbers. None if it is absent or null. Throws std::runtime_error for other
/// values.
std::optional<glm::dvec3> point_of(const Json& said, const char* key);
/// A member that is a finite number. None if it is absent or null. Throws std::runtime_error for other
/// values.
std::optional<double> number_of(const Json& said, const char* key);
/// The shortest text from which the same number is read.
std::string exact(double value);

/// A part of the difference between a dragged piece and another object: its object in a preview, the name of
/// its volume in a picture's header, and its colour.
struct DifferencePart {
  const char* id;
  const char* volume;
  const char* colour;
};
inline constexpr std::array<DifferencePart, 3> difference_parts{
    {{Session::Preview::only_moved, "only_moved_mm3", "#e08a3c"},
     {Session::Preview::only_other, "only_other_mm3", "#5b9dff"},
     {Session::Preview::common, "common_mm3", "#cfd3d6"}}};
/// {"to", and the volume of each part in mm³} for a picture's header. Null if the preview has no difference.
Json difference_json(const Json& preview, const Session::Preview& made);

/// A view's frame as JSON: {"right", "up", "look", "centre_mm", "pixel_mm"}.
Json view_frame_json(const voxel::View& view, const glm::dvec3& centre_mm, double pixel_mm);

}  // namespace octotomy::planner::serve
