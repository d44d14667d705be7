// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A solid by its voxels, which decide on which side a centre lies, and by an expression that places its
/// surface between centres.
struct PlacedSolid {
  const Octree& octree;
  const Expression& solid;
};

/// A place where an object bears a part.
struct DockingContact {
  glm::dvec3 p_mm{0.0};    ///< on the object's surface, LPS
  glm::dvec3 normal{0.0};  ///< unit, out of the object: the direction in which it pushes the part
};

struct DockingContactsOptions {
  double within_mm = 0.4;  ///< the largest gap that counts as contact; above 0
  /// Normals are of planes through the object's surface within this distance, but at least two voxels, as far
  /// as it faces the same way to 37 degrees; which way a place faces is the mean within half of it.
  double smooth_mm = 2.0;
  Progress progress = {};
};

/// Where objects lie against a part: where an edge between voxels' centres crosses an object's surface, and
/// the part begins within a distance along the surface's normal. Throws std::invalid_argument if the distance
/// is not above 0; Stopped. Parallel; the same bits on any number of threads. Cost: some hundred questions of
/// membership for each face of the objects' voxels near the part.
std::vector<DockingContact> docking_contacts(const PlacedSolid& part, const std::vector<PlacedSolid>& objects,
                                             const DockingContactsOptions& options);

/// Places where the part's surface crosses edges between voxels' centres and its outward normal is within 60
/// degrees of the opposite of a push, a unit vector: where a finger can push.
std::vector<glm::dvec3> pushed_surface(const PlacedSolid& part, const glm::dvec3& push);

}  // namespace octotomy::voxel
