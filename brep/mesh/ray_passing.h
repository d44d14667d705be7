// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::brep {

/// How a ray from a point towards +x passes a triangle.
enum class RayPassing { Beside, Leaving, Entering };

/// Exact, however near the triangle the point is, and by the half-open rule: neighbours agree about the edge
/// and the corner they share, so that a ray passes a surface once there. From the triangle's inside out it
/// leaves, as the triangle winds. Precondition: all coordinates are finite. Cost: constant.
RayPassing passing_of(const glm::dvec3& from, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace octotomy::brep
