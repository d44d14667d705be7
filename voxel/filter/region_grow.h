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

/// The seeds, and all voxels that a path of neighbours connects to a seed, with every sample on the path
/// within the tolerance. Throws std::invalid_argument if there is no seed, a seed is not in the scan, or the
/// tolerance is negative or not finite. Cost: that of a window and of its components. Source: Adams and
/// Bischof, IEEE PAMI 16, 1994. Departure: the seeds' samples alone determine the accepted range, so that the
/// result does not depend on the order of growth.
Octree grow_region(const GreyOctree& grey, const GrowOptions& options);

/// The voxels of a region that grows in rounds. Each round adds the region's neighbours whose samples differ
/// from the mean of the region's samples before the round by at most the tolerance. The growth ends with the
/// first round that adds none. The region follows a gradual change of brightness and ends at an abrupt one.
/// Seeds always belong to the region. The result does not depend on the order of seeds; sums are exact.
/// Throws as grow_region() does; Stopped. Source: thesis 2.3.3; Zucker, Computer Graphics and Image
/// Processing 5, 1976. Departure: rounds, because a mean updated after every voxel would depend on the order
/// of voxels. Cost: linear in the region's voxels, its rejected neighbours and, for each round, the number of
/// sample values within the tolerance. Memory: two bits per voxel of the universe, 12 bytes per rejected
/// neighbour.
Octree grow_by_running_mean(const GreyOctree& grey, const GrowOptions& options);

}  // namespace octotomy::voxel
