// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// Reads named points from one of three kinds of file. JSON of this program: { "landmarks": [ { "name": "nasion",
/// "point_mm": [0, -90, 30], "weight": 2 }, ... ] } in LPS millimetres, with the weight 1 where none is stated; also
/// the file of find_landmarks, once each "confirmed" is true. 3D Slicer's markups (.mrk.json): labels and positions
/// of the control points that are placed. Slicer's older .fcsv: one point a line; lines with '#' name the columns,
/// the coordinate system and the version. Slicer's points are converted to LPS if the file states RAS; a .fcsv that
/// states no system is in RAS. Throws std::runtime_error with path and cause: no such list, an entry without name or
/// three finite numbers, an unknown key, a guess that is not confirmed, a coordinate system or unit that is not
/// known.
std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path);

/// Whether a file holds landmarks by its extension: .json or .fcsv.
bool is_landmarks_file(const std::filesystem::path& path);

/// The factors that convert positions of one of Slicer's markups to LPS millimetres, by its
/// "coordinateSystem" (0 is RAS, 1 is LPS; default: LPS) and "coordinateUnits" (default: mm). Throws
/// std::runtime_error if either is unknown.
glm::dvec3 lps_mm_of_markup(const nlohmann::json& markup);

}  // namespace octotomy::planner
