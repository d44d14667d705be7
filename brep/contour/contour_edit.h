// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "brep/contour/contour.h"

// Edits of a contour by hand. Each answers a new contour and leaves the old; pieces of a contour are numbered
// by their first point. Throw std::invalid_argument where a number is beyond the contour, a point is not
// finite, or too few points would be left: three of a closed contour, two of an open one. Whether an edit
// made a contour cross itself is asked of first_crossing().
namespace octotomy::brep {

Contour point_moved(const Contour& contour, std::size_t point, const glm::dvec2& to_mm);
/// On the piece: behind its first point.
Contour point_inserted(const Contour& contour, std::size_t piece, const glm::dvec2& at_mm);
Contour point_deleted(const Contour& contour, std::size_t point);

/// A closed contour cut in two along the straight line between two of its points, which both parts keep; the
/// first part runs from `first` to `second`. Throws also where a part would have fewer than three points.
std::pair<Contour, Contour> split(const Contour& contour, std::size_t first, std::size_t second);
/// An open contour cut at one of its inner points, which both parts keep.
std::pair<Contour, Contour> split(const Contour& contour, std::size_t point);

/// Two closed contours made one through a gate between a piece of each: both pieces go, and their ends are
/// joined crosswise so that the object stays on the left. Throws also where one is open.
Contour joined(const Contour& a, std::size_t piece_of_a, const Contour& b, std::size_t piece_of_b);
/// Two open contours, the end of the first joined to the start of the second.
Contour joined(const Contour& a, const Contour& b);
/// An open contour closed by a straight piece.
Contour closed(const Contour& contour);

/// Two pieces, by number and ascending, that have a point in common beyond the corner that neighbours share;
/// of several the first. Exact. Cost: n log n, and the pairs of pieces whose boxes overlap.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const Contour& contour);

/// The same after an edit, which made or moved the pieces `changed`. Precondition: no two others have such a
/// point in common, as before an edit of a contour that did not cross itself. Cost: linear for each of them.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing_of(const Contour& contour,
                                                                     std::span<const std::size_t> changed);

}  // namespace octotomy::brep
