// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/operation/table/stopwatch.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// What an .octree file holds.
enum class OctreeKind { Binary, Grey, Partial };
/// By its header alone; none if the file cannot be read or is none, which its reader reports.
std::optional<OctreeKind> octree_kind(const std::filesystem::path& path);

/// Reads an .octree file; "read" in the timings.
voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings);

}  // namespace octotomy::planner
