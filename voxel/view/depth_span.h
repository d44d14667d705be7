// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

namespace octotomy::voxel {

/// A range of depths along a ray.
struct DepthSpan {
  double near_mm = -std::numeric_limits<double>::infinity();
  double far_mm = std::numeric_limits<double>::infinity();
};

/// The depths at which the ray start + depth * per_mm, in index space, runs among the centres of a universe's
/// voxels; beyond the outermost centres there is only background. None if it misses them.
inline std::optional<DepthSpan> span_among_centres(const glm::dvec3& start, const glm::dvec3& per_mm,
                                                   int side) {
  DepthSpan span;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = -start[axis];
    const double high = side - 1 - start[axis];
    if (per_mm[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    span.near_mm = std::max(span.near_mm, std::min(low / per_mm[axis], high / per_mm[axis]));
    span.far_mm = std::min(span.far_mm, std::max(low / per_mm[axis], high / per_mm[axis]));
  }
  if (!(span.near_mm <= span.far_mm)) return std::nullopt;
  return span;
}

}  // namespace octotomy::voxel
