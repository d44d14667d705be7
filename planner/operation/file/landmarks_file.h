// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// Reads named points from one of three kinds of file. JSON of this program: { "landmarks": [ { "name":
/// "nasion", "point_mm": [0, -90, 30], "weight": 2 }, ... ] } in LPS millimetres, with the default weight 1.
/// The file of find_landmarks is also of this kind; each "confirmed" in it must be true. 3D Slicer's markups
/// (.mrk.json): the labels and positions of the placed control points. Slicer's older .fcsv: one point on
/// each line; lines that begin with '#' state the columns and the coordinate system. Slicer's points are
/// converted to LPS if the file states RAS; a .fcsv that states no system is in RAS. Throws
/// std::runtime_error with path and cause if there is no such list, an entry has no name or no three finite
/// numbers, a key, coordinate system or unit is unknown, or a guess is not confirmed.
std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path);

/// Whether a path has an extension of landmark files: .json or .fcsv.
bool is_landmarks_file(const std::filesystem::path& path);

/// The factors by which positions in one of Slicer's markups are multiplied to obtain LPS millimetres, from
/// its "coordinateSystem" (0 is RAS, 1 is LPS; default: LPS) and "coordinateUnits" (default: mm). Throws
/// std::runtime_error if either is unknown.
glm::dvec3 lps_mm_of_markup(const nlohmann::json& markup);

}  // namespace octotomy::planner
