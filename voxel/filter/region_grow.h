// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/filter/components.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

struct GrowOptions {
  std::vector<glm::ivec3> seeds;  ///< voxels of the universe; at least one
  /// In sample units, at least 0. The region's samples lie in the range of the seeds' samples, widened by the
  /// tolerance at both ends.
  double tolerance = 0.0;
  Neighbours neighbours = Neighbours::Faces;
};

/// The voxels that a path of neighbours with samples within the tolerance connects to a seed, seeds included.
/// Throws std::invalid_argument if there is no seed, a seed is not in the scan, or the tolerance is
/// negative or not finite. Cost: a window and its components. Source: Adams and Bischof, IEEE PAMI 16, 1994.
/// Departure: the seeds alone fix the window, so that the result does not depend on the order of growth.
Octree grow_region(const GreyOctree& grey, const GrowOptions& options);

}  // namespace octotomy::voxel
