// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/slice_bits.h"

#include <algorithm>
#include <cassert>

namespace octotomy::voxel {
namespace {

// Sets `count` bits of a row from voxel x on. Precondition: `count` is a power of 4, and x a multiple of
// `count`.
void set_run(std::uint64_t* row, int x, int count) {
  assert(x >= 0 && count > 0 && x % std::min(count, 64) == 0);
  if (count >= 64) {
    std::fill_n(row + x / 64, count / 64, all_children);
    return;
  }
  row[x / 64] |= ((std::uint64_t{1} << count) - 1) << (x % 64);
}

class SliceReader {
 public:
  SliceReader(int z, SliceBits& slice) : z_(z), slice_(slice) {}

  void read(BlockRef block, int height, int x, int y) {
    const int side = 1 << (2 * height);
    if (block.is_empty() || x >= slice_.side || y >= slice_.side) return;
    if (block.is_full()) return fill(x, y, side);
    const int child_side = side / 4;
    const int layer = 16 * ((z_ / child_side) & 3);
    for (int child = 0; child < 16; ++child) {
      const int child_x = x + (child & 3) * child_side;
      const int child_y = y + (child >> 2) * child_side;
      if (height > 2)
        read(block.child(layer + child), height - 1, child_x, child_y);
      else
        read_word(block.word(layer + child), child_x, child_y);
    }
  }

 private:
  void fill(int x, int y, int side) {
    for (int row = y; row < std::min(y + side, slice_.side); ++row)
      set_run(row_at(row), x, std::min(side, slice_.side - x));
  }
  void read_word(std::uint64_t word, int x, int y) {
    word >>= 16 * (z_ & 3);
    for (int row = 0; row < 4; ++row)
      if (const std::uint64_t bits = (word >> (4 * row)) & 15; bits != 0)
        row_at(y + row)[x / 64] |= bits << (x % 64);
  }
  std::uint64_t* row_at(int y) {
    return slice_.words.data() + static_cast<std::size_t>(y) * slice_.words_per_row;
  }

  int z_;
  SliceBits& slice_;
};

}  // namespace

void read_slice(const Octree& octree, int z, SliceBits& slice) {
  assert(z >= 0 && z < octree.universe().side());
  slice.side = octree.universe().side();
  slice.words_per_row = (slice.side + 63) / 64;
  slice.words.assign(static_cast<std::size_t>(slice.side) * static_cast<std::size_t>(slice.words_per_row), 0);
  SliceReader(z, slice).read(octree.root(), octree.root_height(), 0, 0);
}

}  // namespace octotomy::voxel
