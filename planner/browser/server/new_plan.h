// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::planner::serve {

/// An initial lower bound of bone in a scan's samples: 300 HU, or the brightest of three classes if samples
/// are not Hounsfield units; 1 in a label map. Cost: one pass over samples that are not Hounsfield units.
double bone_low(const voxel::Scene& scene);

/// An initial plan for a scan: the scan "ct", and its bone from bone_low() on as the object "bone". Writes it
/// as NAME.plan.json in `folder`. If a plan of that name for this scan exists, uses that one; does not
/// replace any other file. Returns the plan's path. `series` as in voxel::ReadOptions. Throws as
/// voxel::read_scene() does.
std::filesystem::path plan_of_scan(const std::filesystem::path& scan, const std::filesystem::path& folder,
                                   const voxel::Progress& progress = {}, const std::string& series = {});

/// Writes the head phantom as a scan to `path` if it does not exist. Returns the path.
std::filesystem::path phantom_at(const std::filesystem::path& path, const voxel::Progress& progress = {});

}  // namespace octotomy::planner::serve
