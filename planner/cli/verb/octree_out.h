// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "planner/operation/file/octree_in.h"

// What the verbs that write an .octree file have in common.
namespace octotomy::planner::cli {

/// Puts an answer on standard output, its findings on standard error. Without rows it is of an octree.
int say(const Program& program, const FileAnswer& made, const Timings& timings);

/// What info does for an .octree file.
int info_of_octree(const Program& program, const std::filesystem::path& path);

}  // namespace octotomy::planner::cli
