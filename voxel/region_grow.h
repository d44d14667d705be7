// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/components.h"
#include "voxel/grey_octree.h"

namespace octotomy::voxel {

struct GrowOptions {
  std::vector<glm::ivec3> seeds;  ///< voxels of the universe; at least one
  /// How far a sample may lie from those of the seeds, in sample units: the region's samples are within the
  /// seeds' range, this much wider at both ends. At least 0.
  double tolerance = 0.0;
  Neighbours neighbours = Neighbours::Faces;
};

/// The voxels that a path of neighbours joins to a seed through samples within the tolerance. All seeds are
/// in the region. Throws std::invalid_argument where there is no seed, a seed is not in the universe, or the
/// tolerance is negative or not finite. Cost: that of a window and its components. Source: Adams and Bischof,
/// IEEE PAMI 16, 1994; departure: the window is fixed by the seeds and not moved by what joins, so that the
/// order of growth is of no account.
Octree grow_region(const GreyOctree& grey, const GrowOptions& options);

}  // namespace octotomy::voxel
