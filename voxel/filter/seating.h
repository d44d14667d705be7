// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "voxel/filter/shadow.h"

namespace octotomy::voxel {

struct SeatingOptions {
  /// Unit vector, LPS: the direction in which the part moves to its place.
  glm::dvec3 direction{0.0, 1.0, 0.0};
  Progress progress = {};
};

/// The place where an object reaches deepest into the space that a part passes through.
struct Binding {
  glm::dvec3 at_mm{0.0};  ///< a voxel's centre
  /// Distance from at_mm to the centre of the nearest voxel outside of that space, less half a voxel edge.
  double depth_mm = 0.0;
};

struct Seating {
  std::optional<Binding> binding;  ///< none: no voxel of the object is in that space
  double swept_mm3 = 0.0;          ///< volume of the space that the part passes through, within the universe
};

/// Examines whether a part can be moved from outside along a direction to its place. The space that the part
/// passes through is its shadow() against that direction, within the universe. The depth to which the object
/// reaches into this space is accurate to a voxel's diagonal, half of it for each of the two digitised
/// surfaces. Throws as shadow() does. Parallel; same bits on any thread count. Cost: shadow() of the part,
/// and a distance map over the voxels that the object shares with this space.
Seating seating(const Octree& part, const Expression& part_solid, const Octree& object,
                const SeatingOptions& options);

}  // namespace octotomy::voxel
