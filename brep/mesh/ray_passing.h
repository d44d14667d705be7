// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::brep {

/// How a ray from a point towards +x crosses a triangle.
enum class RayPassing { Beside, Leaving, Entering };

/// Exact, however near to the triangle the point is. By the half-open rule neighbours agree about a shared
/// edge or corner, so that a ray crosses a surface there once. A ray leaves if it crosses from inside to
/// outside by the triangle's winding. Precondition: all coordinates are finite. Cost: constant.
RayPassing passing_of(const glm::dvec3& from, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace octotomy::brep
