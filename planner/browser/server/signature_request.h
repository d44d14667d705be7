// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {} -> {"signatures": [{"by", "as", "note", "at", "plan_sha256", "scans_sha256", "changed_since"}]}: who has signed the plan, and the
/// parts that have changed since. Cost: reads the scans' files.
Json signatures(Session& session, const Json& said, const Watched& watched);
/// {"by", "as", "note"} -> as signatures(), with one more, which is recorded as an edit. Throws voxel::Error, Input, if the name is
/// empty, a text is too long for a list or has control characters, or the plan is changed while its scans are read.
Json sign_plan(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
