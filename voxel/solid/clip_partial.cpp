// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/clip_partial.h"

#include <cstdint>
#include <stdexcept>

#include "voxel/solid/combine.h"

namespace octotomy::voxel {

PartialOctree within(const PartialOctree& partial, const Octree& voxels) {
  const Universe& universe = partial.touching.universe();
  if (voxels.universe() != universe)
    throw std::invalid_argument("a solid and the voxels to keep of it are of different universes");
  PartialOctree kept{combine(universe, Expression(partial.inside) & voxels),
                     combine(universe, Expression(partial.touching) & voxels),
                     {}};
  for_each_boundary_voxel(partial, [&](const glm::ivec3& voxel, std::uint16_t fraction) {
    if (voxels.contains(voxel)) kept.fractions.push_back(fraction);
  });
  return kept;
}

}  // namespace octotomy::voxel
