// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace octotomy::brep {

/// The angle in radians between the normals of two triangles at their common edge: positive if the surface is
/// convex, zero if a triangle has no area. The normals may have any length; `along` is the edge as the first
/// triangle runs along it. Accurate for small angles, for which an arc cosine is not.
inline double dihedral_angle(const glm::dvec3& normal, const glm::dvec3& normal_beyond,
                             const glm::dvec3& along) {
  const glm::dvec3 across = glm::cross(normal, normal_beyond);
  // Adds zero, because for zero vectors the dot product may be -0, for which atan2 returns half a turn.
  return std::atan2(std::copysign(glm::length(across), glm::dot(across, along)),
                    glm::dot(normal, normal_beyond) + 0.0);
}

}  // namespace octotomy::brep
