// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/dense_bits.h"

#include <algorithm>

#include "voxel/tree/slice_bits.h"

namespace octotomy::bench {

DenseBits dense_bits_of(const voxel::Octree& octree) {
  DenseBits bits{octree.universe().side(), {}};
  voxel::SliceBits slice;
  for (int z = 0; z < bits.side; ++z) {
    voxel::read_slice(octree, z, slice);
    bits.words.insert(bits.words.end(), slice.words.begin(), slice.words.end());
  }
  return bits;
}

}  // namespace octotomy::bench
