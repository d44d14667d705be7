// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/region_grow.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "voxel/solid/combine.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {

Octree grow_region(const GreyOctree& grey, const GrowOptions& options) {
  if (options.seeds.empty()) throw InvalidInput("a region needs at least one seed");
  if (!std::isfinite(options.tolerance) || options.tolerance < 0.0)
    throw InvalidInput("a region's tolerance must be at least zero, not " +
                       std::to_string(options.tolerance));
  const int side = grey.universe().side();
  double low = grey.sample(options.seeds.front());
  double high = low;
  for (const glm::ivec3& seed : options.seeds) {
    if (glm::any(glm::lessThan(seed, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(seed, glm::ivec3(side))))
      throw InvalidInput("the seed " + std::to_string(seed.x) + " " + std::to_string(seed.y) + " " +
                         std::to_string(seed.z) + " is outside the universe of " + std::to_string(side) +
                         " voxels a side");
    if (!grey.scan().contains(seed))
      throw InvalidInput("the seed " + std::to_string(seed.x) + " " + std::to_string(seed.y) + " " +
                         std::to_string(seed.z) +
                         " lies beyond the scan or on padding, where nothing was measured");
    low = std::min(low, static_cast<double>(grey.sample(seed)));
    high = std::max(high, static_cast<double>(grey.sample(seed)));
  }
  const double tolerance = options.tolerance / grey.step();
  const Octree window = combine(grey.universe(), Window{grey, low - tolerance, high + tolerance});
  return components_at(window, options.seeds, options.neighbours);
}

}  // namespace octotomy::voxel
