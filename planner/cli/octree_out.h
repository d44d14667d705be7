// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb.h"
#include "planner/file/octree_in.h"

// What the verbs that write an .octree file have in common.
namespace octotomy::planner::cli {

/// Puts an answer on standard output, its findings on standard error. Without rows it is of an octree.
int say(const Program& program, const FileAnswer& made, const Timings& timings);

/// Writes the file and says of it what info does, the findings, and what else `more` has. Throws Stopped
/// before anything is written where the program is asked to stop.
int write_and_say(const Program& program, const voxel::OctreeFile& file, const std::filesystem::path& out,
                  Timings& timings, const std::vector<std::string>& findings = {},
                  const Json& more = Json::object());

}  // namespace octotomy::planner::cli
