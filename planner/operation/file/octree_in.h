// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/operation/table/stopwatch.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// The kind of octree in an .octree file.
enum class OctreeKind { Binary, Grey, Partial };
/// The kind of an .octree file by its header alone; none if the file cannot be read or is no .octree file,
/// which its reader reports.
std::optional<OctreeKind> octree_kind(const std::filesystem::path& path);

/// Reads an .octree file; "read" in the timings.
voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings);

}  // namespace octotomy::planner
