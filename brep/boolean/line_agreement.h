// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/boolean/corefine.h"
#include "brep/mesh/solid.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// A line along x whose intervals inside a result differ from the Boolean of its intervals inside the
/// operands.
struct LineDisagreement {
  ResultPlace result = of_union;
  glm::dvec3 at_mm{0.0};   ///< where the line crosses the shell for which it was chosen
  double length_mm = 0.0;  ///< total length inside only one of both: the result, or the Boolean of the
                           ///< intervals
};

/// The corners of a triangle in mm.
using Corners = std::array<glm::dvec3, 3>;

Corners corners(const Triangles& surface, std::size_t face);

/// For each shell, its widest triangle, projected along x; also some triangles spread over the surface.
/// Shells are connected across points. Cost: linear, about 30 ns per triangle.
std::vector<Corners> widest_triangles(const Triangles& surface);

/// The worst disagreement of lines through given triangles of operands and results; none if they agree up to
/// rounding. Every line through a shell that is surplus, missing or inverted disagrees. A point is inside if
/// the surface winds around it at least once, so operands that intersect themselves agree with their results.
/// Uses no part of the algorithm that made the results. A disagreement counts only if three lines through the
/// triangle show it: a single line may graze a steep side, where rounded points move far. Shells as thin as
/// rounding are not detected. Preconditions: the results are closed, and their triangles refer to finite
/// points. The same bits on any number of threads. Cost: linear, about 10 ns per triangle, and log n for each
/// crossing.
std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted,
                                                         const std::vector<Corners>& through);

/// Tests along lines through widest_triangles() of the operands and the wanted results. Cost: as above, plus
/// that of widest_triangles().
std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted);

/// The disagreement as text for a message, to follow the name of the result.
std::string text_of(const LineDisagreement& disagreement);

}  // namespace octotomy::brep
