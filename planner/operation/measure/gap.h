// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/solid.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The least distance between two objects, in both kernels.
struct Gap {
  double voxel_mm = 0.0;          ///< between the faces of voxels; 0 if the objects share a voxel or touch
  std::optional<double> mesh_mm;  ///< between triangles; 0 if the solids overlap or touch
  /// The volume that both objects share, if the gap is 0.
  double overlap_mm3 = 0.0;
  glm::dvec3 from_mm{0.0}, to_mm{0.0};  ///< the nearest voxels' centres
};

/// Precondition: neither octree is empty, and both have the same universe. The mesh kernel's gap is computed
/// only if both solids are present and not empty. Cost: a distance map over the first object's extents;
/// brep::gap().
Gap gap_between(const voxel::Octree& a, const voxel::Octree& b, const std::optional<brep::Solid>& solid_a,
                const std::optional<brep::Solid>& solid_b);

}  // namespace octotomy::planner
