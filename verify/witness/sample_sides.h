// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "verify/witness/reading.h"

// Computes the sides of a point from the sides of the samples around it. Private to this room.
namespace octotomy::verify {

/// A point within this distance of a sample, in samples, counts as that sample: the rounding of coordinates.
constexpr double same_place = 1e-6;

/// Whether a sample is certainly inside or certainly outside.
struct SampleSide {
  bool is_in = false;   ///< surely inside
  bool is_out = false;  ///< surely outside
};

/// Returns the side of the sample if the point is at a sample. Elsewhere returns the side on which all
/// surrounding samples agree, or either_side if they do not agree. Points beyond the scan's voxels are
/// outside. `side` is called for indices that may lie outside of the scan by one.
template <typename Side>
AllowedSides sides_by_samples(const glm::dvec3& place, const glm::ivec3& dims, const Side& side) {
  const glm::dvec3 nearest = glm::floor(place + 0.5);
  if (glm::any(glm::greaterThan(glm::abs(place - glm::dvec3(dims - 1) * 0.5),
                                glm::dvec3(dims) * 0.5 + same_place)))
    return certainly_out;
  // Along an axis on which the point is at a sample, only that sample counts.
  glm::ivec3 low(glm::floor(place)), high = low + 1;
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(place[axis] - nearest[axis]) <= same_place)
      low[axis] = high[axis] = static_cast<int>(nearest[axis]);
  bool all_in = true, all_out = true;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const SampleSide here = side(glm::ivec3(x, y, z));
        all_in = all_in && here.is_in;
        all_out = all_out && here.is_out;
      }
  return all_in ? certainly_in : all_out ? certainly_out : either_side;
}

}  // namespace octotomy::verify
