// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {} -> {"table", "cephalogram", "findings"}: the plan's cephalometric measures before and after it, as in a result, and
/// their tracing on the radiograph as a PNG in base64; the latter is empty if no object comes from a scan. Evaluates
/// all objects, because landmarks move with them; `findings` name the steps that failed. Throws voxel::Error, Input, if
/// the plan's landmarks allow no measure.
Json cephalometry(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
