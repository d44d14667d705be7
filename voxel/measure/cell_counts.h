// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// How often each of the 256 patterns of 2 x 2 x 2 voxels occurs around the corners of the lattice. Euler
/// numbers and Lindblad's area are sums over these counts. Bit x + 2y + 4z of a pattern is the voxel at (x,
/// y, z) of the eight; voxels beyond the universe are outside. The full and the empty pattern are not
/// counted; their entries are 0. Parallel; same numbers on any thread count. Cost: one step per 64 voxels,
/// and one per corner on the boundary.
std::array<std::uint64_t, 256> cell_counts(const Octree& octree);

/// Number of components minus number of handles plus number of cavities, for two adjacencies of voxels.
struct EulerNumbers {
  std::int64_t by_faces = 0;    ///< object by 6 neighbours, background by 26
  std::int64_t by_corners = 0;  ///< object by 26 neighbours, background by 6
};
/// Source: Toriwaki and Yonekura, Forma 17, 2002.
EulerNumbers euler_numbers(const Octree& octree);

}  // namespace octotomy::voxel
