// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// A saw cut: a line of straight pieces swept in one direction, as wide as the blade.
struct Saw {
  ObjectName object;
  std::vector<glm::dvec3> line_mm;  ///< LPS; two points or more
  /// The direction in which the blade goes in, LPS, of any length. None: that of the plane.
  std::optional<glm::dvec3> direction;
  double depth_mm = 100.0;      ///< from the line's point that the blade meets first
  double kerf_mm = 1.0;         ///< width of the cut, half on either side of the line
  std::filesystem::path plane;  ///< a plane of 3D Slicer in the place of line, direction and depth
};

/// The saw with the line, direction and depth of its plane, if it has one: the blade enters at the side of the
/// plane's rectangle where its second axis is least, and goes along that axis to the other side. `folder` is that
/// of the plan. Findings on the file are added. Throws std::runtime_error if the file is no plane, or has no bounds.
Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder, std::vector<std::string>& findings);
Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder);

}  // namespace octotomy::planner
