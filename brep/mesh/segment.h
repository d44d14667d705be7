// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace octotomy::brep {

/// The position of the nearest point on the segment from a to b, as a share of the segment's length; 0 for a
/// segment without length.
template <int dims>
double share_along(const glm::vec<dims, double>& p, const glm::vec<dims, double>& a,
                   const glm::vec<dims, double>& b) {
  const glm::vec<dims, double> along = b - a;
  const double length2 = glm::dot(along, along);
  return length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
}

}  // namespace octotomy::brep
