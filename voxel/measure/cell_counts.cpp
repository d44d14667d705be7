// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/cell_counts.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "voxel/tree/corner_patterns.h"

namespace octotomy::voxel {
namespace {

using Counts = std::array<std::uint64_t, 256>;

// Eight times the contribution of a corner of the pattern to each Euler number: 8 corners share a voxel, 4 a
// face, 2 an edge.
struct Share {
  int by_faces = 0;
  int by_corners = 0;
};

Share share_of(unsigned pattern) {
  assert(pattern <= 255U);
  const auto tally = [&](unsigned mask, int& every, int& any) {
    every += (pattern & mask) == mask;
    any += (pattern & mask) != 0;
  };
  int pairs = 0, pairs_any = 0, quads = 0, quads_any = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned step = 1U << axis;
    for (unsigned v = 0; v < 8; ++v)
      if ((v & step) == 0) tally(1U << v | 1U << (v | step), pairs, pairs_any);
    // The four voxels on one side of the corner along this axis share an edge that ends at the corner.
    unsigned low = 0;
    for (unsigned v = 0; v < 8; ++v)
      if ((v & step) == 0) low |= 1U << v;
    tally(low, quads, quads_any);
    tally(~low & 255U, quads, quads_any);
  }
  const int voxels = std::popcount(pattern);
  const int octets = pattern == 255U;
  const int octets_any = pattern != 0U;
  return {voxels - 2 * pairs + 4 * quads - 8 * octets,
          8 * octets_any - 4 * quads_any + 2 * pairs_any - voxels};
}

}  // namespace

std::array<std::uint64_t, 256> cell_counts(const Octree& octree) {
  const int side = octree.universe().side();
  return tbb::parallel_reduce(
      tbb::blocked_range<int>(0, side + 1, 16), Counts{},
      [&](const tbb::blocked_range<int>& part, Counts counts) {
        SliceBits below;
        SliceBits above;
        const auto read = [&](int z, SliceBits& slice) -> const SliceBits* {
          if (z < 0 || z >= side) return nullptr;
          read_slice(octree, z, slice);
          return &slice;
        };
        const SliceBits* before = read(part.begin() - 1, below);
        for (int z = part.begin(); z < part.end(); ++z) {
          const SliceBits* after = read(z, above);
          for_each_corner(before, after, side, [&](int, int, std::uint8_t pattern) { ++counts[pattern]; });
          std::swap(below, above);
          before = after == nullptr ? nullptr : &below;
        }
        return counts;
      },
      [](Counts a, const Counts& b) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
        return a;
      });
}

EulerNumbers euler_numbers(const Octree& octree) {
  const Counts counts = cell_counts(octree);
  EulerNumbers eightfold;
  for (unsigned pattern = 1; pattern < 255; ++pattern) {
    const Share share = share_of(pattern);
    eightfold.by_faces += share.by_faces * static_cast<std::int64_t>(counts[pattern]);
    eightfold.by_corners += share.by_corners * static_cast<std::int64_t>(counts[pattern]);
  }
  return {eightfold.by_faces / 8, eightfold.by_corners / 8};
}

}  // namespace octotomy::voxel
