// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stop_token>
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
  std::stop_token stop{};  ///< of grow_by_running_mean()
};

/// The voxels that a path of neighbours with samples within the tolerance connects to a seed, seeds included.
/// Throws std::invalid_argument if there is no seed, a seed is not in the scan, or the tolerance is
/// negative or not finite. Cost: a window and its components. Source: Adams and Bischof, IEEE PAMI 16, 1994.
/// Departure: the seeds alone fix the window, so that the result does not depend on the order of growth.
Octree grow_region(const GreyOctree& grey, const GrowOptions& options);

/// The voxels of a region that grows in rounds. In each round all its neighbours join whose samples lie
/// within the tolerance of the mean of the region's samples before the round; the growth ends with the first
/// round that adds none. The region follows a slow change of brightness and ends at a step of it. Seeds
/// belong to the region in any case. Independent of the order of seeds; sums are exact. Throws as
/// grow_region(); Stopped. Source: thesis 2.3.3; Zucker, Computer Graphics and Image Processing 5, 1976.
/// Departure: rounds, because a mean updated after every voxel would depend on the order of voxels. Cost: the
/// region, its rejected neighbours and, for each round, the number of sample values within the tolerance.
/// Memory: two bits per voxel of the universe,
/// 12 bytes per rejected neighbour.
Octree grow_by_running_mean(const GreyOctree& grey, const GrowOptions& options);

}  // namespace octotomy::voxel
