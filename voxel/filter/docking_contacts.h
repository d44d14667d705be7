// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A solid in two forms. The octree determines which voxels' centres are inside; the expression determines
/// where the surface lies between centres.
struct PlacedSolid {
  const Octree& octree;
  const Expression& solid;
};

/// A point at which an object supports a part.
struct DockingContact {
  glm::dvec3 p_mm{0.0};  ///< on the object's surface, LPS
  /// Unit vector out of the object: the direction in which the object pushes the part.
  glm::dvec3 normal{0.0};
};

struct DockingContactsOptions {
  double within_mm = 0.4;  ///< the largest gap that counts as contact; above 0
  /// A contact's normal is that of a plane fitted to the object's surface within this distance, or within two
  /// voxel edges if these are longer, where the surface faces the same way to 37 degrees. The direction in which
  /// a place faces is the mean normal within half of the distance.
  double smooth_mm = 2.0;
  Progress progress = {};
};

/// The contacts of objects with a part. A contact is a point where an edge between voxels' centres crosses an
/// object's surface, if the part begins within the distance `within_mm` along the surface's normal. Throws
/// std::invalid_argument if the distance is not above 0; Stopped. Parallel; the same bits on any number of
/// threads. Cost: some hundred membership queries for each face of the objects' voxels near the part.
std::vector<DockingContact> docking_contacts(const PlacedSolid& part, const std::vector<PlacedSolid>& objects,
                                             const DockingContactsOptions& options);

/// Points at which a finger can push a part in the direction `push`, a unit vector, LPS: where the part's
/// surface crosses edges between voxels' centres, and its outward normal is within 60 degrees of -push.
std::vector<glm::dvec3> pushed_surface(const PlacedSolid& part, const glm::dvec3& push);

}  // namespace octotomy::voxel
