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

/// A line along x on which a result is not the Boolean of what the line has inside the operands.
struct LineDisagreement {
  ResultPlace result = of_union;
  glm::dvec3 at_mm{0.0};   ///< where the line passes the shell that it was laid through
  double length_mm = 0.0;  ///< of all stretches that only one of the two has
};

/// The corners of a triangle in mm.
using Corners = std::array<glm::dvec3, 3>;

Corners corners(const Triangles& surface, std::size_t face);

/// The triangle of each shell that is widest as seen along x, and some from all over the surface. Shells are
/// connected across points. Cost: linear, some 30 ns a triangle.
std::vector<Corners> widest_triangles(const Triangles& surface);

/// The worst disagreement of lines through given triangles of operands and results, none where they agree to
/// rounding. Of a shell that should not be there, is missing or winds the wrong way, each line through it
/// tells. Inside is where a surface winds at least once, so operands that meet themselves agree with what is
/// made of them. Knows nothing of how the results came about. A disagreement counts if three lines through
/// the triangle share it: one may graze a steep side, on which rounded points move far. Shells that are as
/// thin as rounding pass. Preconditions: the results are closed, and their triangles refer to finite points.
/// The same bits on any number of threads. Cost: linear, some 10 ns a triangle, and log n for each crossing.
std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted,
                                                         const std::vector<Corners>& through);

/// The same through widest_triangles() of the operands and the wanted results. Cost: theirs too.
std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted);

/// What a message says of it, behind the name of the result.
std::string text_of(const LineDisagreement& disagreement);

}  // namespace octotomy::brep
