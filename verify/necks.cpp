// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/necks.h"

#include <algorithm>

#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {

const voxel::Octree& Necks::set_of(const std::vector<glm::ivec3>& group) const {
  return octree_.contains(group.front()) ? octree_ : digitised_;
}

Necks::Held& Necks::held_of(const std::vector<glm::ivec3>& group) {
  return octree_.contains(group.front()) ? by_voxels_ : by_mesh_;
}

voxel::Octree Necks::connected(const voxel::Octree& part) const {
  const voxel::Octree common =
      voxel::combine(octree_.universe(), voxel::Expression(octree_) & voxel::Expression(digitised_));
  return voxel::components_that_meet(part, common, voxel::Neighbours::Corners);
}

bool Necks::is_attached(const std::vector<glm::ivec3>& group) {
  std::optional<voxel::Octree>& held = held_of(group).whole;
  if (!held) held = connected(set_of(group));
  return held->contains(group.front());
}

bool Necks::is_thick(const std::vector<glm::ivec3>& group) {
  std::optional<voxel::Octree>& held = held_of(group).eroded;
  if (!held) {
    const glm::dvec3 voxel_mm = octree_.universe().lattice().spacing_mm();
    constexpr double past_one_voxel = 1.01;
    const double radius_mm = past_one_voxel * std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z});
    held = connected(voxel::erode(set_of(group), radius_mm));
  }
  return std::any_of(group.begin(), group.end(), [&](const glm::ivec3& at) { return held->contains(at); });
}

glm::ivec3 Necks::neck(const std::vector<glm::ivec3>& group) const {
  const int side = octree_.universe().side();
  for (const glm::ivec3& at : group)
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const glm::ivec3 beside = at + glm::ivec3(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
      const bool is_within = glm::all(glm::greaterThanEqual(beside, glm::ivec3(0))) &&
                             glm::all(glm::lessThan(beside, glm::ivec3(side)));
      if (is_within && octree_.contains(beside) && digitised_.contains(beside)) return at;
    }
  return group.front();
}

}  // namespace octotomy::verify
