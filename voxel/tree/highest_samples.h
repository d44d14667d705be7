// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// For cubes of 4, 16, 64, ... cells a side, an upper bound of the trilinear samples in the cube: the highest
/// sample of the leaves that the cube's cells reach. A cell lies between the centres of eight voxels, so the
/// cells of a leaf reach into the next leaf along each axis. Rays skip cubes whose bound is too low.
class HighestSamples {
 public:
  /// Computes the bounds in parallel. Cost: one pass over the ranges of the leaves.
  explicit HighestSamples(const GreyOctree& grey);

  /// The edge, in cells, of the largest aligned cube that contains a cell and whose bound is at most `limit`,
  /// in steps; 0 if there is none. Precondition: 0 <= cell < universe side.
  int edge_without(const glm::ivec3& cell, double limit) const {
    for (std::size_t level = levels_.size(); level-- > 0;)
      if (levels_[level].at(cell >> shift_of(level)) <= limit) return 1 << shift_of(level);
    return 0;
  }
  /// The bound of the cube of 4 cells a side that contains the cell.
  std::int16_t of_leaf(const glm::ivec3& cell) const { return levels_.front().at(cell >> 2); }

 private:
  struct Level {
    int side = 1;
    std::vector<std::int16_t> high;
    std::int16_t at(const glm::ivec3& cube) const { return high[index(cube)]; }
    std::size_t index(const glm::ivec3& cube) const {
      const auto edge = static_cast<std::size_t>(side);
      return static_cast<std::size_t>(cube.x) +
             edge * (static_cast<std::size_t>(cube.y) + edge * static_cast<std::size_t>(cube.z));
    }
  };
  static int shift_of(std::size_t level) { return 2 * static_cast<int>(level) + 2; }
  static Level leaves(const GreyOctree& grey);
  /// Raises the bound of every cube to that of the next cube along an axis if that one is higher.
  static void reach_along(int axis, Level& level);
  static Level coarser(const Level& fine);

  std::vector<Level> levels_;
};

}  // namespace octotomy::voxel
