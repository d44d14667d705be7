// Building proceeds by layers. A layer of height h consists of the blocks of height h with the same z. A
// layer of height 2 is built from 16 slices, a higher layer from four layers of height h - 1. Layers without
// voxels take no time.
#include "voxel/tree/slice_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "voxel/tree/logical_build.h"

namespace octotomy::voxel {
namespace {

void mark_slices(BlockRef block, int height, int z, std::vector<bool>& occupied) {
  const int side = static_cast<int>(occupied.size());
  const int child_side = 1 << (2 * height - 2);
  for (int layer = 0; layer < 4; ++layer) {
    const int first = z + layer * child_side;
    const std::uint64_t children = std::uint64_t{0xffff} << (16 * layer);
    const Node* node = block.node();
    const std::uint64_t full = node != nullptr ? node->full : all_children;
    if ((full & children) != 0) {
      for (int i = first; i < std::min(first + child_side, side); ++i)
        occupied[static_cast<std::size_t>(i)] = true;
      continue;
    }
    for (std::uint64_t rest = node->partial & children; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      if (height > 2) {
        mark_slices(block.child(child), height - 1, first, occupied);
        continue;
      }
      const std::uint64_t word = block.word(child);
      for (int i = 0; i < 4; ++i)
        if ((word & (std::uint64_t{0xffff} << (16 * i))) != 0)
          occupied[static_cast<std::size_t>(first + i)] = true;
    }
  }
}

SliceBits empty_slice(int side) {
  SliceBits slice;
  slice.side = side;
  slice.words_per_row = (side + 63) / 64;
  slice.words.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(slice.words_per_row), 0);
  return slice;
}

class LayerBuild {
 public:
  LayerBuild(const Universe& universe, const std::function<bool(int, SliceBits&)>& draw)
      : side_(universe.side()), draw_(draw) {
    slices_.fill(empty_slice(side_));
  }

  // The blocks of a layer, x fastest; empty if the layer has no voxels.
  std::vector<Block> layer(int height, int z) {
    if (z >= side_) return {};
    if (height == 2) return bottom_layer(z);
    std::array<std::vector<Block>, 4> below;
    bool any = false;
    for (int i = 0; i < 4; ++i) {
      auto& part = below[static_cast<std::size_t>(i)];
      part = layer(height - 1, z + (i << (2 * height - 2)));
      any = any || !part.empty();
    }
    if (!any) return {};
    const int count = blocks_along(height);
    const int count_below = blocks_along(height - 1);
    std::vector<Block> blocks(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x)
        blocks[static_cast<std::size_t>(y * count + x)] = joined(height, x, y, count_below, below);
    return blocks;
  }

 private:
  int blocks_along(int height) const { return std::max(1, side_ >> (2 * height)); }

  static Block joined(int height, int x, int y, int count_below, std::array<std::vector<Block>, 4>& below) {
    std::array<BlockRef, 64> present;
    std::size_t count = 0;
    std::uint64_t full = 0;
    std::uint64_t undecided = 0;
    for (int child = 0; child < 64; ++child) {
      auto& part = below[static_cast<std::size_t>(child >> 4)];
      const int child_x = 4 * x + (child & 3);
      const int child_y = 4 * y + ((child >> 2) & 3);
      if (part.empty() || child_x >= count_below || child_y >= count_below) continue;
      Block& block = part[static_cast<std::size_t>(child_y * count_below + child_x)];
      if (block.ref().is_full()) full |= std::uint64_t{1} << child;
      if (block.ref().node() == nullptr) continue;
      undecided |= std::uint64_t{1} << child;
      present[count++] = block.detach();
    }
    return make_block(height, full, undecided, {present.data(), count});
  }

  std::vector<Block> bottom_layer(int z) {
    bool any = false;
    std::array<bool, 16> drawn{};
    for (int i = 0; i < std::min(16, side_ - z); ++i) {
      drawn[static_cast<std::size_t>(i)] = draw_(z + i, slices_[static_cast<std::size_t>(i)]);
      any = any || drawn[static_cast<std::size_t>(i)];
    }
    if (!any) return {};
    const int count = blocks_along(2);
    std::vector<Block> blocks(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
    for (int y = 0; y < count; ++y)
      draw_blocks(y, count, drawn, &blocks[static_cast<std::size_t>(y * count)]);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      if (drawn[i]) std::fill(slices_[i].words.begin(), slices_[i].words.end(), 0);
    return blocks;
  }

  // Builds the blocks of a layer that have the same y. A word of 64 voxels spans four blocks.
  void draw_blocks(int y, int count, const std::array<bool, 16>& drawn, Block* blocks) const {
    const int words_per_row = slices_.front().words_per_row;
    for (int column = 0; column < words_per_row; ++column) {
      std::array<std::array<std::uint64_t, 64>, 4> words{};
      std::uint64_t any = 0;
      for (int z = 0; z < 16; ++z) {
        if (!drawn[static_cast<std::size_t>(z)]) continue;
        for (int row = 0; row < std::min(16, side_); ++row) {
          const std::uint64_t bits = slices_[static_cast<std::size_t>(z)].row(16 * y + row)[column];
          any |= bits;
          if (bits == 0) continue;
          const int shift = child_index(0, row & 3, z & 3);
          const auto leaf = static_cast<std::size_t>(child_index(0, row >> 2, z >> 2));
          for (int x = 0; x < 16; ++x)
            words[static_cast<std::size_t>(x >> 2)][leaf + static_cast<std::size_t>(x & 3)] |=
                ((bits >> (4 * x)) & 15) << shift;
        }
      }
      if (any == 0) continue;
      for (int i = 0; i < std::min(4, count - 4 * column); ++i)
        blocks[4 * column + i] = make_leaf_block(0, all_children, words[static_cast<std::size_t>(i)].data());
    }
  }

  int side_;
  const std::function<bool(int, SliceBits&)>& draw_;
  std::array<SliceBits, 16> slices_;
};

}  // namespace

std::vector<bool> occupied_slices(const Octree& octree) {
  std::vector<bool> occupied(static_cast<std::size_t>(octree.universe().side()), false);
  if (!octree.is_empty()) mark_slices(octree.root(), octree.root_height(), 0, occupied);
  return occupied;
}

void for_each_slice(const Octree& octree, const std::function<void(int z, const SliceBits& slice)>& visit) {
  const std::vector<bool> occupied = occupied_slices(octree);
  SliceBits slice;
  for (int z = 0; z < octree.universe().side(); ++z) {
    if (!occupied[static_cast<std::size_t>(z)]) continue;
    read_slice(octree, z, slice);
    visit(z, slice);
  }
}

Octree octree_of_slices(const Universe& universe, const std::function<bool(int z, SliceBits& slice)>& draw) {
  check_depth(universe.depth);
  std::vector<Block> root = LayerBuild(universe, draw).layer(root_height(universe.depth), 0);
  return root.empty() ? Octree::empty(universe) : Octree(universe, std::move(root.front()));
}

void set_row(SliceBits& slice, int y, int first, int last) {
  assert(y >= 0 && y < slice.side && first >= 0 && first <= last && last < slice.side);
  std::uint64_t* row =
      slice.words.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(slice.words_per_row);
  const std::uint64_t from = all_children << (first % 64);
  const std::uint64_t to = all_children >> (63 - last % 64);
  if (first / 64 == last / 64) {
    row[first / 64] |= from & to;
    return;
  }
  row[first / 64] |= from;
  std::fill(row + first / 64 + 1, row + last / 64, all_children);
  row[last / 64] |= to;
}

bool next_run(const SliceBits& slice, int y, int from, int& first, int& last) {
  assert(y >= 0 && y < slice.side && from >= 0 && from <= slice.side);
  const std::uint64_t* row = slice.row(y);
  // The first voxel of a row, from x on, that is in the object or, if all bits of `flip` are set, outside the
  // object.
  const auto find = [&](int x, std::uint64_t flip) {
    for (int word = x / 64; word < slice.words_per_row; ++word) {
      std::uint64_t bits = row[word] ^ flip;
      if (word == x / 64) bits &= all_children << (x % 64);
      if (bits != 0) return std::min(64 * word + std::countr_zero(bits), slice.side);
    }
    return slice.side;
  };
  first = find(from, 0);
  if (first >= slice.side) return false;
  last = find(first, all_children) - 1;
  return true;
}

}  // namespace octotomy::voxel
