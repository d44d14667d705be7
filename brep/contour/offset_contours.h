// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// Offsets the area that closed contours enclose. If by_mm is positive, returns the contours of all points
/// within by_mm of the area. If it is negative, returns those of the points of the area that are at least
/// |by_mm| away from its border. Empty if there are no such points. Corners become round, by arcs within a
/// thousandth of by_mm; all points are rounded to about 1e-7 of the contours' extent. Contours that meet are
/// united. Outer contours run counter-clockwise and holes clockwise, each outer one before its holes.
/// Precondition: the contours are simple, disjoint and alternately outer contours and holes, like the results
/// of follow(). Throws std::invalid_argument if one is open or crosses itself, or the length is not finite.
/// Cost: n log n if the offset is smaller than the contours' features. Source: Boost.Geometry's buffer.
std::vector<Contour> offset(const std::vector<Contour>& contours, double by_mm);

}  // namespace octotomy::brep
