// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/morphology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "voxel/build.h"
#include "voxel/combine.h"
#include "voxel/components.h"
#include "voxel/distance_map.h"

namespace octotomy::voxel {
namespace {

void check_radius(double radius_mm) {
  if (!std::isfinite(radius_mm) || radius_mm < 0.0)
    throw std::invalid_argument("a radius must be a number of millimetres of at least zero, not " +
                                std::to_string(radius_mm));
}

// Squares of distances are compared; what lies on the ball's surface counts as within it, though a square may be
// rounded by two units in the last place of a float.
double limit_mm2(double radius_mm) {
  return radius_mm * radius_mm * (1.0 + 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

// Voxels that a ball reaches at most from its centre, along the axis of least spacing.
int reach_voxels(const Universe& universe, double radius_mm) {
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  const double reach = radius_mm / std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  // Two universes away every voxel has been reached.
  return static_cast<int>(std::ceil(std::min(reach, 2.0 * universe.side())));
}

VoxelRange within_universe(VoxelRange range, const Universe& universe) {
  range.low = glm::max(range.low, glm::ivec3(0));
  range.high = glm::min(range.high, glm::ivec3(universe.side() - 1));
  return range;
}

// The voxels of `octree` whose square distance in `map`, over a range that holds it, is more than the limit.
Octree farther(const Octree& octree, const DistanceMap& map, double limit) {
  return combine(octree.universe(), Expression(octree) - octree_within(octree.universe(), map, limit));
}

}  // namespace

Octree dilate(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  const VoxelRange range =
      within_universe(grown(range_of(octree), reach_voxels(octree.universe(), radius_mm)), octree.universe());
  return octree_within(octree.universe(), distance_map(octree, range), limit_mm2(radius_mm));
}

Octree erode(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  return farther(octree, distance_map_of_complement(octree, range_of(octree)), limit_mm2(radius_mm));
}

Octree open(const Octree& octree, double radius_mm) {
  return dilate(erode(octree, radius_mm), radius_mm);
}

Octree close(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  const double limit = limit_mm2(radius_mm);
  const int reach = reach_voxels(octree.universe(), radius_mm);
  // The dilation may leave the universe: it is kept as a map over all it reaches, and its outside as a second.
  const VoxelRange range = grown(range_of(octree), reach);
  DistanceMap map = distance_map(octree, range);
  for (float& square : map.square_mm2) square = static_cast<double>(square) <= limit ? 1.0F : 0.0F;
  const VoxelRange inner = within_universe(range_of(octree), octree.universe());
  return octree_within(octree.universe(), distances_to_zero(map, octree.universe(), inner, limit), 0.0);
}

Octree fill_cavities(const Octree& octree) {
  const Octree outside = combine(octree.universe(), ~Expression(octree));
  return combine(octree.universe(), ~Expression(reaching_faces(outside, Neighbours::Faces)));
}

}  // namespace octotomy::voxel
