// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace octotomy::brep {

/// The angle in radians by which the normals of two triangles part at their common edge: positive where the
/// surface is convex, zero beside a triangle without area. The normals may have any length; `along` is the
/// edge as the first triangle runs along it. Exact for small angles, where an arc cosine is not.
inline double dihedral_angle(const glm::dvec3& normal, const glm::dvec3& normal_beyond,
                             const glm::dvec3& along) {
  const glm::dvec3 across = glm::cross(normal, normal_beyond);
  // Added zero: the cosine of nothing must not be -0, whose angle is a half turn.
  return std::atan2(std::copysign(glm::length(across), glm::dot(across, along)),
                    glm::dot(normal, normal_beyond) + 0.0);
}

}  // namespace octotomy::brep
