// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {

/// The answer of `info` for an octree: `kind`, `fields` ("binary", "grey" or "partial"), `depth`, `levels` of
/// the condensed tree (1..n), `voxels`, `bytes_memory`, `bytes_file` (null with a finding if there is no
/// file), geometry, name and metadata. The voxels of a grey tree are those that are not background; of a
/// partial one, those that its solid touches. A partial one adds the number of voxels wholly inside and the
/// volume by fractions.
Json octree_answer(const voxel::OctreeFile& file, std::optional<std::uint64_t> bytes_file,
                   const Timings& timings);

/// The lines of a scan's audit that are not PASS, at most 32, for `scan_audit` in the metadata of an octree
/// made from the scan. Details that quote the patient are left out.
Json doubts_of(const std::vector<voxel::Finding>& audit);

/// The lines of `scan_audit` in an octree_answer()'s metadata, for people.
std::vector<std::string> told_doubts(const Json& answer);

/// The answer as a text for people.
std::string octree_text(const std::string& title, const Json& answer);

/// Writes the file. Returns octree_answer() with the members of `more`, the findings, and octree_text() as
/// text. Throws voxel::Stopped before anything is written.
FileAnswer octree_written(const voxel::OctreeFile& file, const std::filesystem::path& out,
                          const std::stop_token& stop, Timings& timings,
                          const std::vector<std::string>& findings = {}, const Json& more = Json::object());

}  // namespace octotomy::planner
