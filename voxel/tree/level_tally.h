// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Counts the nodes of a logical octree by level and status, in any order.
class LevelTally {
 public:
  explicit LevelTally(int depth) : by_side_(static_cast<std::size_t>(depth) + 1) {}

  /// Counts a node of 2^side_log2 voxels a side by its status. Returns whether it is Partial.
  bool count(int side_log2, bool is_full, bool is_empty) {
    LevelCount& level = by_side_[static_cast<std::size_t>(side_log2)];
    ++(is_full ? level.full : is_empty ? level.empty : level.partial);
    return !is_full && !is_empty;
  }

  /// Counts the voxels of a leaf word whose bits are set in `mask`, by their status.
  void count_voxels(std::uint64_t word, std::uint64_t mask) {
    by_side_[0].full += static_cast<std::uint64_t>(std::popcount(word & mask));
    by_side_[0].empty += static_cast<std::uint64_t>(std::popcount(~word & mask));
  }

  /// The counts of levels 1..depth; the root is left out.
  std::vector<LevelCount> levels() const {
    std::vector<LevelCount> levels(by_side_.rbegin() + 1, by_side_.rend());
    for (std::size_t i = 0; i < levels.size(); ++i) levels[i].level = static_cast<int>(i) + 1;
    return levels;
  }

 private:
  std::vector<LevelCount> by_side_;
};

}  // namespace octotomy::voxel
