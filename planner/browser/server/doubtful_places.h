// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"scan"} -> {"places": [{"check", "sentence", "at_mm", "plane", "png"}]}: the doubtful places of a scan,
/// each with a slice through it as a PNG in base64, with the doubtful samples tinted. "check" is "gap", a
/// slab that no image measured; "metal", samples as dense as metal; or "headrest", material behind the
/// patient. Metal and headrests are found only in scans in Hounsfield units. Cost: some seconds for the
/// headrest of a whole head.
Json doubtful_places(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
