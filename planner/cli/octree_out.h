// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb.h"
#include "planner/file/octree_in.h"

// What the verbs that write an .octree file have in common.
namespace octotomy::planner::cli {

/// Puts an answer on standard output, its findings on standard error. Without rows it is of an octree.
int say(const Program& program, const FileAnswer& made, const Timings& timings);

}  // namespace octotomy::planner::cli
