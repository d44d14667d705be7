// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"path", "base"} -> {"base", "conflicts": [{"step", "field", "base", "a", "b", "text"}], "rows"}: what a merge with the plan of
/// another file would change, line by line; or the values that both plans changed differently since their common
/// original. `base` is the number of a state of this plan's history; without it, the state from which the other plan differs in
/// the fewest values. Changes nothing.
Json try_merge(Session& session, const Json& said, const Watched& watched);
/// As try_merge(), and records the merged plan as an edit. Throws voxel::Error, Input, with all conflicts if there are any.
Json merge_plan(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
