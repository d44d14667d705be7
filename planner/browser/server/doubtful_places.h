// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"scan"} -> {"places": [{"check", "sentence", "at_mm", "plane", "png"}]}: where a scan is doubtful, each with a slice through
/// the place in which it is tinted, as a PNG in base64. Checks: "gap", a slab that no image measured; "metal", samples as
/// dense as metal; "headrest", what lies behind the patient. The latter two are looked
/// for in Hounsfield units only. Cost: a search for the headrest, seconds on a whole head.
Json doubtful_places(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
