// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::brep {

/// The axis with its sign chosen so that its largest component (the first, if several are equal) is not
/// negative. Needed because the sign of eigenvectors and edges is arbitrary.
inline glm::dvec3 forward(const glm::dvec3& axis) {
  const glm::dvec3 size = glm::abs(axis);
  const int largest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return axis[largest] < 0.0 ? -axis : axis;
}

}  // namespace octotomy::brep
