// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/verb/verb.h"

namespace octotomy::planner::cli {

/// Adds what compares, merges and remembers plans: plan diff, plan merge, plan history.
void add_plan_document(Program& program);

}  // namespace octotomy::planner::cli
