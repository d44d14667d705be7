// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// Removes points that are collinear within max_distance_mm from a contour: every removed point lies within
/// this distance of the piece that replaces it. The first point stays, and at least three points of a closed
/// contour, two of an open one. If the distance is above zero, a thinned contour may cross itself or another
/// one. Throws std::invalid_argument if the distance is negative or not finite. Cost: n log n; at worst n
/// times the longest run of points whose distances equal the limit up to rounding.
Contour thin(const Contour& contour, double max_distance_mm);

}  // namespace octotomy::brep
