// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"view", "position_mm", "seed_mm", "scan", "tolerance" or "low" and "high"} -> {"polygons_mm", "sample"}:
/// the contours of a region of a scan's slice around a seed, first its outline and then its holes, in the
/// view's millimetres. With "object" in place of a scan and seed: the contours at which the plane cuts its
/// surface. Points are thinned to "thin_mm".
Json trace_contours(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
