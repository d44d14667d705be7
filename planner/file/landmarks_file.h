// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "brep/align/register_landmarks.h"

namespace octotomy::planner {

/// Reads named points from JSON: ours,
///   { "landmarks": [ { "name": "nasion", "point_mm": [0, -90, 30], "weight": 2 }, ... ] }
/// in LPS millimetres, weights 1 where absent, also as find_landmarks writes them once each "confirmed" is
/// true; or 3D Slicer's markups (.mrk.json, its control points' labels and positions, turned to LPS where it
/// says RAS; points that are not placed are passed over).
/// Throws std::runtime_error with path and what is wrong: no such list, an entry without name or three
/// finite numbers, an unknown key, a guess that is not confirmed, a coordinate system that is neither.
std::vector<brep::Landmark> read_landmarks(const std::filesystem::path& path);

}  // namespace octotomy::planner
