// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/drawn_object.h"

#include "voxel/solid/combine.h"

namespace octotomy::voxel {

std::vector<DrawnObject> built(std::vector<DrawnObject> objects) {
  for (DrawnObject& object : objects) {
    if (!object.unbuilt) continue;
    object.octree = combine(object.octree.universe(), *object.unbuilt);
    object.unbuilt.reset();
  }
  return objects;
}

}  // namespace octotomy::voxel
