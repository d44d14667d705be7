// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// The contours of all points of a plane within by_mm of what closed contours enclose, or for by_mm below 0
/// of those that far inside; none where there are none. Corners come out round, by arcs that lie within a
/// thousandth of by_mm; all points are rounded to about 1e-7 of the contours' extent. Contours that come to
/// meet are united; outer ones run counter-clockwise and holes clockwise, each outer one before its holes.
/// Precondition: the contours are simple, apart from each other and nested in turns, as follow() leaves them.
/// Throws std::invalid_argument where one is open or crosses itself, or the length is not finite. Cost: n log
/// n where the offset is smaller than the contours' features. Source: Boost.Geometry's buffer.
std::vector<Contour> offset(const std::vector<Contour>& contours, double by_mm);

}  // namespace octotomy::brep
