// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/browser/server/message.h"
#include "planner/browser/server/session.h"

namespace octotomy::planner::serve {

/// {"view", "position_mm", "seed_mm", "scan", "tolerance" or "low" and "high"} -> {"polygons_mm", "sample"}:
/// in a slice of a scan, the contours of the region around a seed, its outline first and then its holes, in
/// the view's millimetres. With "object" in place of scan and seed: the contours in which the slice cuts the
/// object's surface. Points within "thin_mm" of the remaining contour may be left out.
Json trace_contours(Session& session, const Json& said, const Watched& watched);

}  // namespace octotomy::planner::serve
