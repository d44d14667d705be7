// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/verb/verb.h"

namespace octotomy::planner::cli {

/// Adds the verb procedure: a plan of an operation that has a name.
void add_procedure(Program& program);

}  // namespace octotomy::planner::cli
