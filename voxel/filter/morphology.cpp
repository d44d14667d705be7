// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/morphology.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "voxel/filter/components.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/rounded.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

void check_radius(double radius_mm) {
  if (!std::isfinite(radius_mm) || radius_mm < 0.0)
    throw InvalidInput("a radius must be at least 0 mm and finite, not " + std::to_string(radius_mm));
}

// The largest squared distance within the ball, in mm^2. It is raised so that it includes voxels on the
// ball's surface although their squared distances may be rounded up by two units in the last place of a
// float.
double limit_mm2(double radius_mm) {
  assert(radius_mm >= 0.0);
  return radius_mm * radius_mm * (1.0 + 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

// The ball's radius in voxels along the axis of least spacing.
int reach_voxels(const Universe& universe, double radius_mm) {
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  const double reach = radius_mm / std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  // A radius of two universes' sides already covers every voxel.
  return static_cast<int>(std::ceil(std::min(reach, 2.0 * universe.side())));
}

VoxelRange within_universe(VoxelRange range, const Universe& universe) {
  range.low = glm::max(range.low, glm::ivec3(0));
  range.high = glm::min(range.high, glm::ivec3(universe.side() - 1));
  return range;
}

}  // namespace

Octree dilate(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  const VoxelRange range =
      within_universe(grown(range_of(octree), reach_voxels(octree.universe(), radius_mm)), octree.universe());
  const double limit = limit_mm2(radius_mm);
  return octree_where(octree.universe(), distance_map(octree, range),
                      [&](double square_mm2) { return square_mm2 <= limit; });
}

Octree erode(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  const double limit = limit_mm2(radius_mm);
  return octree_where(octree.universe(), distance_map_of_complement(octree, range_of(octree)),
                      [&](double square_mm2) { return square_mm2 > limit; });
}

Octree open(const Octree& octree, double radius_mm) {
  return dilate(erode(octree, radius_mm), radius_mm);
}

Octree close(const Octree& octree, double radius_mm) {
  check_radius(radius_mm);
  const double limit = limit_mm2(radius_mm);
  // The dilation may leave the universe, so its map covers the dilation and a shell around it. No voxel
  // beyond the shell is nearer to the dilation than the shell's voxels.
  const VoxelRange range = grown(range_of(octree), reach_voxels(octree.universe(), radius_mm) + 1);
  const glm::dvec3 dims(range.dims());
  const double bytes = dims.x * dims.y * dims.z * sizeof(float);
  if (bytes > static_cast<double>(free_memory()))
    throw Error(ErrorCode::Resource, "closing by " + rounded(radius_mm) + " mm takes " +
                                         rounded(bytes / 1e9) +
                                         " GB of memory: choose a smaller radius or larger voxels");
  DistanceMap map = distance_map(octree, range);
  for (float& square_mm2 : map.square_mm2)
    square_mm2 = static_cast<double>(square_mm2) > limit ? 0.0F : std::numeric_limits<float>::infinity();
  spread(map, octree.universe());
  return octree_where(octree.universe(), map, [&](double square_mm2) { return square_mm2 > limit; });
}

Octree fill_cavities(const Octree& octree) {
  const Octree outside = combine(octree.universe(), ~Expression(octree));
  return combine(octree.universe(), ~Expression(components_at_faces(outside)));
}

}  // namespace octotomy::voxel
