// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/operation/table/stopwatch.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// The kind of an octree in an .octree file: binary or grey.
enum class OctreeKind { Binary, Grey, Partial };
/// The kind in an .octree file's header. None if the file cannot be read or is not an .octree file; its
/// reader then reports the reason.
std::optional<OctreeKind> octree_kind(const std::filesystem::path& path);

/// Reads an .octree file. Adds "read" to the timings.
voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings);

}  // namespace octotomy::planner
