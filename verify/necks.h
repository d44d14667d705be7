// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// A neck of fewer voxels across may be there or not: on the scan it is a matter of noise and of the voxels'
/// place.
inline constexpr int bridge_voxels = 3;

/// How parts that one kernel alone has hold to what both have. Keeps references to both sets of voxels.
class Necks {
 public:
  Necks(const voxel::Octree& octree, const voxel::Octree& digitised)
      : octree_(octree), digitised_(digitised) {}

  /// Whether a path through the voxels of its own set leads from a group of voxels, all of one set, to what
  /// both sets have. A part that the other set lacks altogether hangs on nothing. Cost: of the first call a
  /// labelling of the set.
  bool is_attached(const std::vector<glm::ivec3>& group);
  /// Whether a neck of bridge_voxels or more holds a group of voxels, all of one set: the set eroded by a
  /// voxel still connects one of them with what both sets have. Cost: of the first call an erosion and a
  /// labelling of the set.
  bool is_thick(const std::vector<glm::ivec3>& group);
  /// A voxel of the group that touches what both sets have; the group's first one where none does.
  glm::ivec3 neck(const std::vector<glm::ivec3>& group) const;

 private:
  /// What of a set, whole or eroded by a voxel, is connected with what both sets have.
  struct Held {
    std::optional<voxel::Octree> whole, eroded;
  };
  /// Of the set that has the group.
  Held& held_of(const std::vector<glm::ivec3>& group);
  const voxel::Octree& set_of(const std::vector<glm::ivec3>& group) const;
  voxel::Octree connected(const voxel::Octree& part) const;

  const voxel::Octree &octree_, &digitised_;
  Held by_voxels_, by_mesh_;
};

}  // namespace octotomy::verify
