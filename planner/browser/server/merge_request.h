// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"path", "base"} -> {"base", "conflicts": [{"step", "field", "base", "a", "b", "text"}], "rows"}: compares
/// this plan and the plan of a file with their common original. "rows" are the changes that a merge would
/// make, line by line; "conflicts" are the values that both plans changed differently. "base" is the number
/// of the original in this plan's history. If the request lacks it, the original is the state from which the
/// other plan differs in the fewest values. Changes nothing.
Json try_merge(Session& session, const Json& said, const Watched& watched);
/// As try_merge(), and records the merged plan as an edit. Throws voxel::Error, Input, with all conflicts if
/// both plans changed a value differently.
Json merge_plan(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
