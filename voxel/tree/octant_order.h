// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/tree/octree_node.h"

// A node's 64 children are numbered x + 4y + 16z (octree_node.h); the thesis's two levels of eight number
// them 8 octant + child, where octant and child are each x + 2y + 4z. Both are the same six bits of (x, y, z)
// in another order, so masks change order by exchanging bits of their index.

namespace octotomy::voxel {

/// The child number of an octant's child x + 2y + 4z minus that of the octant's first child.
constexpr int octant_child(int number) {
  return child_index(number & 1, (number >> 1) & 1, number >> 2);
}

/// A mask of the eight children of octant x + 2y + 4z.
constexpr std::uint64_t octant_mask(int octant) {
  return octant_children << (2 * octant_child(octant));
}

/// Moves every bit of a word to a new index: its index with bits `low` and `high` exchanged. Source: delta
/// swaps, Knuth, The Art of Computer Programming 4A, 7.1.3.
template <int low, int high>
constexpr std::uint64_t exchange_index_bits(std::uint64_t word) {
  constexpr std::uint64_t movers = [] {
    std::uint64_t mask = 0;
    for (int i = 0; i < 64; ++i)
      if (((i >> low) & 1) == 1 && ((i >> high) & 1) == 0) mask |= std::uint64_t{1} << i;
    return mask;
  }();
  constexpr int distance = (1 << high) - (1 << low);
  const std::uint64_t differ = ((word >> distance) ^ word) & movers;
  return word ^ differ ^ (differ << distance);
}

/// Reorders a mask from bit x + 4y + 16z to bit 8 octant + child, so that each octant is a byte.
constexpr std::uint64_t octant_ordered(std::uint64_t mask) {
  return exchange_index_bits<3, 4>(exchange_index_bits<2, 4>(exchange_index_bits<1, 2>(mask)));
}

/// The inverse of octant_ordered().
constexpr std::uint64_t child_ordered(std::uint64_t mask) {
  return exchange_index_bits<1, 2>(exchange_index_bits<2, 4>(exchange_index_bits<3, 4>(mask)));
}

}  // namespace octotomy::voxel
