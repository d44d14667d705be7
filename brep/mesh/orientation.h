// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::brep {

/// The side of a plane or line on which a point lies, exactly for the given doubles: +1 or -1, and 0 only for
/// a point on the plane or line. Precondition: all coordinates are finite. Cost: constant; exact numbers are
/// used only within rounding of 0. Source: CGAL's filtered predicates.

/// Side of the plane through a, b, c; +1 on the side to which (b - a) x (c - a) points.
int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& p);

/// Side of the line from a to b in their plane; +1 on the left.
int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p);

}  // namespace octotomy::brep
