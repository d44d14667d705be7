// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// One slice of a universe as packed bits: row y begins at word y * words_per_row, voxel x is bit x % 64 of
/// the row's word x / 64.
struct SliceBits {
  int side = 0;
  int words_per_row = 0;
  std::vector<std::uint64_t> words;

  const std::uint64_t* row(int y) const { return words.data() + static_cast<std::size_t>(y) * words_per_row; }
};

/// Reads the octree's voxels with index z into a slice, which may be reused. Precondition: z is in the
/// universe.
void read_slice(const Octree& octree, int z, SliceBits& slice);

}  // namespace octotomy::voxel
