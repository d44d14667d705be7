// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::planner::serve {

/// An initial lower bound of bone in a scan's samples: 300 HU; 1 in a label map; for other samples the
/// brightest of three classes. Cost: one pass over samples that are not in Hounsfield units.
double bone_low(const voxel::Scene& scene);

/// Makes an initial plan for a scan: the scan "ct", and the object "bone" with the samples from bone_low()
/// on. Writes it as NAME.plan.json into `folder`. Uses an existing plan of that name if it is for this scan,
/// and never replaces another file. Returns the plan's path. `series` as in voxel::ReadOptions. Throws as
/// voxel::read_scene() does.
std::filesystem::path plan_of_scan(const std::filesystem::path& scan, const std::filesystem::path& folder,
                                   const voxel::Progress& progress = {}, const std::string& series = {});

/// Writes a scan of the head phantom to `path` if there is no such file. Returns the path.
std::filesystem::path phantom_at(const std::filesystem::path& path, const voxel::Progress& progress = {});

}  // namespace octotomy::planner::serve
