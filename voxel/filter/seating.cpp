// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/seating.h"

#include <algorithm>
#include <cmath>

#include "voxel/measure/distance_map.h"
#include "voxel/solid/combine.h"

namespace octotomy::voxel {

Seating seating(const Octree& part, const Expression& part_solid, const Octree& object,
                const SeatingOptions& options) {
  const Universe& universe = part.universe();
  const Lattice lattice = universe.lattice();
  // Beyond the whole universe.
  const Box world = bounds(lattice);
  const glm::dvec3 away = -options.direction;
  const double end_mm = glm::dot(away, glm::mix(world.low_mm, world.high_mm,
                                                glm::dvec3(glm::greaterThan(away, glm::dvec3(0.0))))) +
                        glm::length(lattice.spacing_mm());
  const Shadow way = shadow(part, part_solid, {away, end_mm, options.progress});
  const Octree swept = combine(universe, Expression(way.window));
  Seating made;
  made.swept_mm3 = static_cast<double>(swept.voxel_count()) * lattice.voxel_mm3();
  const Octree both = combine(universe, Expression(swept) & Expression(object));
  const VoxelRange range = range_of(both);
  if (range.is_empty()) return made;
  const VoxelRange swept_range = grown(range_of(swept), 1);
  const DistanceMap map = distance_map_of_complement(swept, swept_range);
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double half_mm = 0.5 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  float deepest = -1.0F;
  for (int z = range.low.z; z <= range.high.z; ++z)
    for (int y = range.low.y; y <= range.high.y; ++y)
      for (int x = range.low.x; x <= range.high.x; ++x) {
        const glm::ivec3 voxel(x, y, z);
        const float square = map.square_mm2[map.index(voxel)];
        if (square <= deepest || !both.contains(voxel)) continue;
        deepest = square;
        made.binding = {lattice.lps_mm(glm::dvec3(voxel)), std::sqrt(static_cast<double>(square)) - half_mm};
      }
  options.progress.at(1.0);
  return made;
}

}  // namespace octotomy::voxel
