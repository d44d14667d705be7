// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {} -> {"signatures": [{"by", "as", "note", "at", "plan_sha256", "scans_sha256", "changed_since"}]}: who
/// has signed the plan; "changed_since" lists what has changed after each signature. Cost: reads all files of
/// the scans.
Json signatures(Session& session, const Json& said, const Watched& watched);
/// {"by", "as", "note"} -> as signatures(), including the new signature, which is recorded as an edit of the
/// plan. Throws voxel::Error, Input, if the name is empty, if a text is too long or contains control
/// characters, or if the plan is changed while its scans are read.
Json sign_plan(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
