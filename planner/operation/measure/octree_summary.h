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
/// file), geometry, name and metadata. In a grey tree, `voxels` counts those that are not background; in a
/// partial tree, those that the solid touches. The answer for a partial tree also has the number of voxels
/// wholly inside and the volume by fractions.
Json octree_answer(const voxel::OctreeFile& file, std::optional<std::uint64_t> bytes_file,
                   const Timings& timings);

/// The lines of a scan's audit that are not PASS, at most 32. They become `scan_audit` in the metadata of an
/// octree that is made from the scan. Details that quote patient data are left out.
Json doubts_of(const std::vector<voxel::Finding>& audit);

/// The lines of `scan_audit` in the metadata of an octree_answer(), as text for people.
std::vector<std::string> told_doubts(const Json& answer);

/// The answer as a text for people.
std::string octree_text(const std::string& title, const Json& answer);

/// Writes an octree's file. Returns octree_answer() with the members of `more`, its findings, and
/// octree_text(). Throws voxel::Stopped before anything is written.
FileAnswer octree_written(const voxel::OctreeFile& file, const std::filesystem::path& out,
                          const std::stop_token& stop, Timings& timings,
                          const std::vector<std::string>& findings = {}, const Json& more = Json::object());

}  // namespace octotomy::planner
