// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "planner/measure/result_json.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// What `info` says of an octree: `kind`, `fields` ("binary", "grey" or "partial"), `depth`, `levels` of the
/// condensed tree (1..n), `voxels`, `bytes_memory`, `bytes_file` (null with a finding where there is no
/// file), geometry, name and metadata. The voxels of a grey tree are those that are not background, of a
/// partial one those that its solid touches; a partial one adds how many lie wholly inside and the volume by
/// fractions.
Json octree_answer(const voxel::OctreeFile& file, std::optional<std::uint64_t> bytes_file,
                   const Timings& timings);

/// The same for people.
std::string octree_text(const std::string& title, const Json& answer);

}  // namespace octotomy::planner
