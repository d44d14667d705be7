// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cassert>

#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

/// A row of a slice, as bits whose index is that of a corner. Bit i of `ahead` is the voxel after corner i of
/// the word; bit i of `behind` is the voxel before that corner. Rows outside the universe are empty. A row
/// has one more corner than it has voxels; the last corner may need a further word.
struct RowBits {
  const std::uint64_t* words = nullptr;
  int count = 0;
  std::uint64_t ahead(int word) const { return words != nullptr && word < count ? words[word] : 0; }
  std::uint64_t behind(int word) const { return (ahead(word) << 1) | (word > 0 ? ahead(word - 1) >> 63 : 0); }
};

/// Row y of a slice. Empty if y lies outside or `slice` is null.
inline RowBits row_of(const SliceBits* slice, int y) {
  if (slice == nullptr || y < 0 || y >= slice->side) return {};
  return {slice->row(y), slice->words_per_row};
}

/// Calls visit(x, y, pattern) for the corners between two slices whose eight voxels are not all alike, y by
/// y. Corner (x, y) is the lowest corner of voxel (x, y) of `above`. Bit x + 2y + 4z of the pattern is voxel
/// (x, y, z) of the eight. A slice outside the universe is null. Cost: one step per 64 corners, and one per
/// call of `visit`.
template <typename Visit>
void for_each_corner(const SliceBits* below, const SliceBits* above, int side, const Visit& visit) {
  assert((below == nullptr || below->side == side) && (above == nullptr || above->side == side));
  for (int y = 0; y <= side; ++y) {
    const std::array<RowBits, 4> rows{row_of(below, y - 1), row_of(below, y), row_of(above, y - 1),
                                      row_of(above, y)};
    std::array<std::uint64_t, 4> carry{};
    for (int word = 0; word <= side / 64; ++word) {
      std::array<std::uint64_t, 8> bits;
      std::uint64_t any = 0;
      std::uint64_t all = all_children;
      for (std::size_t i = 0; i < 4; ++i) {
        const std::uint64_t ahead = rows[i].ahead(word);
        bits[2 * i] = ahead << 1 | carry[i];
        bits[2 * i + 1] = ahead;
        carry[i] = ahead >> 63;
        any |= bits[2 * i] | bits[2 * i + 1];
        all &= bits[2 * i] & bits[2 * i + 1];
      }
      for (std::uint64_t mixed = any & ~all; mixed != 0; mixed &= mixed - 1) {
        const int bit = std::countr_zero(mixed);
        unsigned pattern = 0;
        for (std::size_t i = 0; i < 8; ++i) pattern |= static_cast<unsigned>((bits[i] >> bit) & 1) << i;
        visit(64 * word + bit, y, static_cast<std::uint8_t>(pattern));
      }
    }
  }
}

}  // namespace octotomy::voxel
