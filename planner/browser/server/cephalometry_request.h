// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {} -> {"table", "cephalogram", "findings"}: the cephalometric measures of the plan's landmarks before and
/// after the operation, as in a result, and the tracing on the radiograph as a PNG in base64. "cephalogram"
/// is empty if no object comes from a scan. Evaluates all objects, because landmarks move with them;
/// "findings" name the steps that failed. Throws voxel::Error, Input, if the plan's landmarks allow no
/// measure.
Json cephalometry(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
