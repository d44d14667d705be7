// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The points deeper than `depth_mm` in a convex solid: the intersection of the half-spaces of its sides,
/// each moved inward. Exact but for the rounding of points, so edges stay sharp. The empty solid if no point
/// lies so deep. None if the solid is not convex, or if its hull has more than 2^12 sides, where offset() is
/// equally fast and accurate. LPS millimetres. A solid counts as convex if every point lies within 2^-30 of
/// the solid's extent from the surface of its convex hull, and the volumes differ by at most this length
/// times the hull's area. Precondition: depth_mm is above 0. Throws Stopped. Cost: n log n to test convexity,
/// linear if an edge shows that the solid is not convex; then sides times the edges of the result.
std::optional<Solid> convex_inset(const Solid& solid, double depth_mm, const Progress& progress = {});

}  // namespace octotomy::brep
