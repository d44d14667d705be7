// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "planner/operation/file/octree_in.h"

// Printed output of verbs that write an .octree file.
namespace octotomy::planner::cli {

/// Prints an answer to standard output and its findings to standard error. If the answer has no rows of its
/// own, prints those of an octree. Returns the exit status: `disagreement` if the answer's "verdict" or a
/// finding is a FAIL, else `done`.
int say(const Program& program, const FileAnswer& made, const Timings& timings);

/// Prints the facts of an .octree file, for `octotomy info`. Returns the exit status.
int info_of_octree(const Program& program, const std::filesystem::path& path);

}  // namespace octotomy::planner::cli
