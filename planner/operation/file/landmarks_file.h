// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// Reads named points from JSON: ours,
///   { "landmarks": [ { "name": "nasion", "point_mm": [0, -90, 30], "weight": 2 }, ... ] }
/// in LPS millimetres, weights 1 where absent, also as find_landmarks writes them once each "confirmed" is
/// true; or 3D Slicer's markups (.mrk.json, its control points' labels and positions; points that are not
/// placed are passed over); or its older .fcsv: a point a line, whose columns, coordinate system and version
/// the lines with '#' name. Slicer's points are turned to LPS where the file says RAS, and .fcsv where it
/// says nothing, which then was RAS. Throws std::runtime_error with path and what is wrong: no such list, an
/// entry without name or three finite numbers, an unknown key, a guess that is not confirmed, a coordinate
/// system or unit that is not known.
std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path);

/// Whether a file holds landmarks by its extension: .json or .fcsv.
bool is_landmarks_file(const std::filesystem::path& path);

/// The factors that convert positions of one of Slicer's markups to LPS millimetres, by its
/// "coordinateSystem" (0 is RAS, 1 is LPS; default: LPS) and "coordinateUnits" (default: mm). Throws
/// std::runtime_error if either is unknown.
glm::dvec3 lps_mm_of_markup(const nlohmann::json& markup);

}  // namespace octotomy::planner
