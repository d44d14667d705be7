// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

#include "planner/operation/table/stopwatch.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// Reads an .octree file; "read" in the timings.
voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings);

}  // namespace octotomy::planner
