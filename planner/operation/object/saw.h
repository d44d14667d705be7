// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// A saw cut: the volume that straight pieces of a line sweep in one direction, as wide as the blade.
struct Saw {
  ObjectName object;
  std::vector<glm::dvec3> line_mm;  ///< at least two points, LPS mm
  /// The direction in which the blade enters, LPS, of any length. None: determined by the plane.
  std::optional<glm::dvec3> direction;
  double depth_mm = 100.0;      ///< depth along the direction, from the point of the line that the blade
                                ///< reaches first
  double kerf_mm = 1.0;         ///< width of the cut, half on either side of the line
  std::filesystem::path plane;  ///< file of a 3D Slicer plane, instead of line, direction and depth
};

/// The saw with the line, direction and depth of its plane, if it has one. The blade enters on the side of
/// the plane's rectangle with the smallest coordinate along the second axis, and moves along that axis to the
/// other side. `folder` is the plan's folder. Appends findings on the file. Throws std::runtime_error if the
/// file contains no plane, or the plane has no bounds.
Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder, std::vector<std::string>& findings);
Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder);

}  // namespace octotomy::planner
