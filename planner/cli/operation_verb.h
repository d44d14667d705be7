// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb.h"

namespace octotomy::planner::cli {

/// Adds a verb for every operation of the table that works on files: a plan of one step. Its options, their
/// checks and its help come from the operation's fields.
void add_operation_verbs(Program& program);

}  // namespace octotomy::planner::cli
