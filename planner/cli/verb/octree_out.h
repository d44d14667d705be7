// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "planner/operation/file/octree_in.h"

// Common output of verbs that write an .octree file.
namespace octotomy::planner::cli {

/// Prints an answer to standard output and its findings to standard error. Without rows, prints the rows of
/// an octree. Returns the exit status: `disagreement` where the answer's `verdict` or a finding is a FAIL.
int say(const Program& program, const FileAnswer& made, const Timings& timings);

/// Runs `info` for an .octree file.
int info_of_octree(const Program& program, const std::filesystem::path& path);

}  // namespace octotomy::planner::cli
