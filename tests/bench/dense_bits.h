// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::bench {

/// The simplest competitor: one bit a voxel of the whole universe, x fastest, 64 voxels a word.
struct DenseBits {
  int side = 0;
  std::vector<std::uint64_t> words;
};
DenseBits dense_bits_of(const voxel::Octree& octree);

}  // namespace octotomy::bench
