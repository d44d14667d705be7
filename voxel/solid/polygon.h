// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::voxel {

/// The area that a closed polygon encloses, positive if counter-clockwise; the closing edge is implied.
/// Computed relative to the first point, so that no digits are lost if the polygon is far from the origin.
inline double signed_area(const std::vector<glm::dvec2>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
    const glm::dvec2 a = polygon[last] - polygon.front();
    const glm::dvec2 b = polygon[i] - polygon.front();
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

/// The square of the distance between a point and a segment, whose ends may coincide.
inline double square_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double square = glm::dot(along, along);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  const glm::dvec2 to = a + t * along - p;
  return glm::dot(to, to);
}

}  // namespace octotomy::voxel
