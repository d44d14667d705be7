// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A landmark and its displacement, LPS millimetres.
struct LandmarkShift {
  glm::dvec3 p_mm{0.0}, by_mm{0.0};
};

/// Deforms the space of an expression by landmarks. A voxel is in the result if the origin of its centre is
/// in the expression. Each landmark moves by its displacement. Places farther than `reach_mm` from all
/// landmarks keep the voxels of `still`. In between the displacement is a sum of Wendland's functions (1-r)^4
/// (4r+1) about the landmarks, r = distance / reach_mm (Fornefett, Rohr, Stiehl 2001). The origin x of a
/// point p is the solution of x = p - u(x), by fixed-point iteration; u is the displacement.
///
/// Preconditions: `still` is combine() of the expression in its universe; the displacement changes by less than 1 mm per
/// mm everywhere. Throws InvalidInput if there is no landmark, a number is not finite, `reach_mm` is not above 0 or two
/// landmarks coincide; Error (Geometry) with the place if an origin is not found; Stopped. Parallel; same bits on any
/// thread count. Cost: for each voxel within reach, a step per landmark and one evaluation of the expression.
Octree warped_by_landmarks(const Octree& still, const Expression& expression,
                           const std::vector<LandmarkShift>& landmarks, double reach_mm,
                           const Progress& progress = {});

}  // namespace octotomy::voxel
