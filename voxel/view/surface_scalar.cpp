// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/surface_scalar.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "voxel/space/error.h"
#include "voxel/view/lab.h"

namespace octotomy::voxel {

double SurfaceScalar::at(const glm::dvec3& p_voxel) const {
  const glm::dvec3 p =
      glm::clamp(p_voxel, glm::dvec3(range.low), glm::dvec3(range.high)) - glm::dvec3(range.low);
  const glm::ivec3 dims = range.dims();
  const glm::ivec3 low(glm::min(glm::floor(p), glm::dvec3(glm::max(dims - 2, glm::ivec3(0)))));
  const glm::ivec3 high = glm::min(low + 1, dims - 1);
  const glm::dvec3 t = p - glm::dvec3(low);
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::bvec3 upper(corner & 1, corner & 2, corner & 4);
    const glm::ivec3 at = glm::mix(low, high, upper);
    const glm::dvec3 weight = glm::mix(1.0 - t, t, upper);
    const std::size_t index = static_cast<std::size_t>(at.x) +
                              static_cast<std::size_t>(dims.x) *
                                  (static_cast<std::size_t>(at.y) +
                                   static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
    sum += weight.x * weight.y * weight.z * static_cast<double>(values[index]);
  }
  return sum;
}

SurfaceScalar distance_to(const Octree& other, const Octree& object, double most_mm) {
  if (!(std::isfinite(most_mm) && most_mm > 0.0))
    throw InvalidInput("the range of distances must be positive, in mm");
  if (other.universe() != object.universe())
    throw InvalidInput(
        "the two objects have different universes: combine one into the other's universe first");
  if (other.is_empty() || object.is_empty())
    throw InvalidInput("an empty object has no surface: choose objects with at least one voxel");
  // One voxel is added, because the surface extends beyond the outermost voxels' centres.
  const VoxelRange range = grown(range_of(object), 1);
  return {other.universe(), range, signed_distances_mm(other, range), most_mm};
}

glm::vec3 diverging_colour(double share) {
  const glm::dvec3 blue(42.0, 8.0, -44.0), middle(94.0, 0.0, 3.0), orange(42.0, 42.0, 52.0);
  const double t = std::clamp(share, -1.0, 1.0);
  return srgb_from_lab(glm::mix(middle, t < 0.0 ? blue : orange, std::abs(t)));
}

std::vector<glm::vec3> diverging_colours(int count) {
  std::vector<glm::vec3> colours;
  colours.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) colours.push_back(diverging_colour((2.0 * i + 1.0) / count - 1.0));
  return colours;
}

}  // namespace octotomy::voxel
