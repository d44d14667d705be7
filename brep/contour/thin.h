// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// The contour without points that are collinear within max_distance_mm: every point left out lies no further
/// than that from the piece that stands for it. The first point stays; at least three points of a closed
/// contour do, two of an open one. At distances above zero a thinned contour may cross itself or another.
/// Throws std::invalid_argument where the distance is negative or not finite. Cost: n log n; n times the
/// longest run of points whose distances are the largest allowed but for rounding.
Contour thin(const Contour& contour, double max_distance_mm);

}  // namespace octotomy::brep
