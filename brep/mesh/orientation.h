// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::brep {

/// On which side of a plane or line a point lies, for the doubles as they stand: +1, -1, or 0 only where it
/// lies on it. Precondition: all coordinates are finite. Cost: constant; exact numbers are
/// called for only within rounding of 0. Source: CGAL's filtered predicates.

/// Of the plane through a, b, c; +1 where (b - a) x (c - a) points to.
int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& p);

/// Of the line from a to b in their plane; +1 on the left.
int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p);

}  // namespace octotomy::brep
