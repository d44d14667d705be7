// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"
#include "voxel/tree/logical_node.h"
#include "voxel/tree/octant_order.h"

namespace octotomy::voxel {

/// Throws std::invalid_argument if no universe has this depth.
inline void check_depth(int depth) {
  if (depth < 2 || depth > Universe::max_depth)
    throw InvalidInput("a universe has a depth of 2 to " + std::to_string(Universe::max_depth) + ", not " +
                       std::to_string(depth));
}

/// Builds an octree from the statuses of its nodes in preorder. `source.open(level)` returns the next node's
/// status. `source.close(homogeneous)` is called after the children of a Partial node; `homogeneous` means
/// that all are Full or all Empty. A source that does not accept homogeneous children throws; otherwise they
/// are condensed into their parent. Precondition: no node at the level of voxels is Partial.
template <typename Source>
class LogicalBuild {
 public:
  LogicalBuild(const Universe& universe, Source& source) : universe_(universe), source_(source) {}

  Octree octree() {
    check_depth(universe_.depth);
    const Status status = source_.open(0);
    if (status == Status::Full) return Octree::full(universe_);
    if (status == Status::Empty) return Octree::empty(universe_);
    const int height = root_height(universe_.depth);
    if (universe_.depth == 2) {
      const std::uint64_t voxels = word();
      return {universe_, make_leaf_block(0, 1, &voxels)};
    }
    if (universe_.depth % 2 == 0) return {universe_, block(height)};
    Children children;
    octant(height, 0, children);
    return {universe_, joined(height, children)};
  }

 private:
  // The children of a block that is being built, by child number.
  struct Children {
    std::uint64_t full = 0;
    std::uint64_t partial = 0;
    std::array<std::uint64_t, 64> words;
    std::array<Block, 64> blocks;
  };

  /// Opens the eight children of a node, and calls `inside(k, status)` for those that are not Empty.
  template <typename Inside>
  void eight(int level, const Inside& inside) {
    int full = 0;
    int empty = 0;
    for (int k = 0; k < 8; ++k) {
      const Status status = source_.open(level);
      full += status == Status::Full;
      empty += status == Status::Empty;
      if (status != Status::Empty) inside(k, status);
    }
    source_.close(full == 8 || empty == 8);
  }

  Block block(int height) {
    Children children;
    eight(universe_.depth - 2 * height + 1, [&](int k, Status status) {
      if (status == Status::Full)
        children.full |= octant_mask(k);
      else
        octant(height, k, children);
    });
    return joined(height, children);
  }

  void octant(int height, int number, Children& children) {
    eight(universe_.depth - 2 * height + 2, [&](int k, Status status) {
      const int index = 2 * octant_child(number) + octant_child(k);
      const std::uint64_t bit = std::uint64_t{1} << index;
      const auto i = static_cast<std::size_t>(index);
      (status == Status::Full ? children.full : children.partial) |= bit;
      if (status == Status::Full) return;
      if (height == 2)
        children.words[i] = word();
      else
        children.blocks[i] = block(height - 1);
    });
  }

  std::uint64_t word() {
    std::uint64_t voxels = 0;
    eight(universe_.depth - 1, [&](int k, Status status) {
      if (status == Status::Full) {
        voxels |= octant_mask(k);
        return;
      }
      eight(universe_.depth, [&](int voxel, Status) {
        voxels |= std::uint64_t{1} << (2 * octant_child(k) + octant_child(voxel));
      });
    });
    return voxels;
  }

  static Block joined(int height, Children& children) {
    std::array<std::uint64_t, 64> words;
    std::array<BlockRef, 64> blocks;
    std::size_t count = 0;
    for (std::uint64_t rest = children.partial; rest != 0; rest &= rest - 1, ++count) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      if (height == 2)
        words[count] = children.words[i];
      else
        blocks[count] = children.blocks[i].detach();
    }
    if (height == 2) return make_leaf_block(children.full, children.partial, words.data());
    return make_block(height, children.full, children.partial, {blocks.data(), count});
  }

  Universe universe_;
  Source& source_;
};

}  // namespace octotomy::voxel
