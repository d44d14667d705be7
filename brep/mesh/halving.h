// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

namespace octotomy::brep {

/// Nodes of a binary tree over `count` items that is halved, the first half the smaller, down to leaves of at
/// most `leaf_size`: so that halves can be laid out in preorder before they are built, and built in parallel.
/// Cost: log n.
inline std::uint32_t halving_nodes(std::uint32_t count, std::uint32_t leaf_size) {
  // Halves differ by one at most, so that each level has two sizes only, `small` and one more.
  std::uint64_t nodes = 0, small = count, small_count = 1, large_count = 0;
  while (small_count + large_count > 0) {
    nodes += small_count + large_count;
    if (small <= leaf_size) small_count = 0;
    if (small + 1 <= leaf_size) large_count = 0;
    const std::uint64_t of_small = small_count, of_large = large_count;
    small_count = small % 2 == 0 ? 2 * of_small + of_large : of_small;
    large_count = small % 2 == 0 ? of_large : of_small + 2 * of_large;
    small /= 2;
  }
  return static_cast<std::uint32_t>(nodes);
}

}  // namespace octotomy::brep
