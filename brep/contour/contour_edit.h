// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "brep/contour/contour.h"

// Manual edits of a contour. Each returns a new contour and does not change the old one. A piece of a contour
// has the number of its first point. Throw std::invalid_argument if a number is beyond the contour, a point
// is not finite, or too few points would be left: fewer than three for a closed contour, two for an open one.
// first_crossing() reports whether an edit made a contour cross itself.
namespace octotomy::brep {

Contour point_moved(const Contour& contour, std::size_t point, const glm::dvec2& to_mm);
/// Inserts a point into a piece, after the piece's first point.
Contour point_inserted(const Contour& contour, std::size_t piece, const glm::dvec2& at_mm);
Contour point_deleted(const Contour& contour, std::size_t point);

/// Divides a closed contour in two along the straight line between two of its points, which both parts keep;
/// the first part runs from `first` to `second`. Also throws if a part would have fewer than three points.
std::pair<Contour, Contour> split(const Contour& contour, std::size_t first, std::size_t second);
/// Divides an open contour at one of its inner points, which both parts keep.
std::pair<Contour, Contour> split(const Contour& contour, std::size_t point);

/// Joins two closed contours at a piece of each: both pieces are removed and their ends are connected
/// crosswise, so that the object stays on the left. Also throws if one is open.
Contour joined(const Contour& a, std::size_t piece_of_a, const Contour& b, std::size_t piece_of_b);
/// Joins two open contours, the end of the first to the start of the second.
Contour joined(const Contour& a, const Contour& b);
/// Closes an open contour by a straight piece.
Contour closed(const Contour& contour);

/// The first two pieces (numbers ascending) that have a common point other than the corner that neighbours
/// share. Exact. Cost: n log n, and the pairs of pieces whose boxes overlap.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const Contour& contour);

/// As first_crossing(), after an edit that created or moved the pieces `changed`. Precondition: no two other
/// pieces have a common point except a shared corner, which holds if the contour did not cross itself before
/// the edit. Cost: linear for each changed piece.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing_of(const Contour& contour,
                                                                     std::span<const std::size_t> changed);

}  // namespace octotomy::brep
