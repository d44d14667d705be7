// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::planner::serve {

/// Where bone begins in a scan's own samples, to begin with: 300 HU, or the brightest of three classes where
/// samples are no Hounsfield units; 1 in a label map. Cost: one pass over the samples that are none.
double bone_low(const voxel::Scene& scene);

/// The plan with which work on a scan begins: the scan "ct", and its bone as the object "bone", from
/// bone_low() on. It is written as NAME.plan.json in `folder`; where a plan of that name begins with this
/// very scan it is the one that is gone on with, and any other is left alone. Returns the plan's path. Throws
/// as voxel::read_scene().
std::filesystem::path plan_of_scan(const std::filesystem::path& scan, const std::filesystem::path& folder,
                                   const voxel::Progress& progress = {});

/// The head phantom as a scan at `path`, where it is made once. Returns the path.
std::filesystem::path phantom_at(const std::filesystem::path& path, const voxel::Progress& progress = {});

}  // namespace octotomy::planner::serve
