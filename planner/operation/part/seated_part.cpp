// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/seated_part.h"

#include "planner/operation/measure/digitised.h"

namespace octotomy::planner {

void check_against(const ObjectName& part, const std::vector<ObjectName>& against,
                   const FieldLocation& place) {
  for (const ObjectName& object : against)
    if (object.name == part.name)
      place.at("against").refuse("names the part '" + part.name +
                                 "' itself: name the bone or the teeth on which it sits");
}

std::optional<std::string> missing_kernel(const Object& object, const std::string& consequence) {
  if (object.voxel.octree.is_empty() || !object.voxel.symbol)
    return why_no_voxels(object) + ": " + consequence;
  if (!object.mesh.within || object.mesh.within->empty())
    return "'" + object.id +
           "' has no mesh, so the kernels cannot check each other: make the object by steps that both "
           "kernels have";
  return std::nullopt;
}

}  // namespace octotomy::planner
