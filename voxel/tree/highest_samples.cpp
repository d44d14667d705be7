// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/highest_samples.h"

#include <algorithm>
#include <limits>
#include <tbb/parallel_for.h>

namespace octotomy::voxel {

HighestSamples::HighestSamples(const GreyOctree& grey) {
  levels_.push_back(leaves(grey));
  for (int axis = 0; axis < 3; ++axis) reach_along(axis, levels_.front());
  while (levels_.back().side > 1) levels_.push_back(coarser(levels_.back()));
}

HighestSamples::Level HighestSamples::leaves(const GreyOctree& grey) {
  const int side = std::max(1, grey.universe().side() / 4);
  const auto count = static_cast<std::size_t>(side);
  Level level{side, std::vector<std::int16_t>(count * count * count)};
  const int bricks = (side + 3) / 4;
  tbb::parallel_for(0, bricks, [&](int brick_z) {
    for (int brick_y = 0; brick_y < bricks; ++brick_y)
      for (int brick_x = 0; brick_x < bricks; ++brick_x) {
        const glm::ivec3 block(brick_x, brick_y, brick_z);
        const GreyBrick& brick = grey.brick(block);
        for (int leaf = 0; leaf < 64; ++leaf) {
          const glm::ivec3 at = 4 * block + glm::ivec3(leaf & 3, (leaf >> 2) & 3, leaf >> 4);
          if (glm::any(glm::greaterThanEqual(at, glm::ivec3(side)))) continue;
          level.high[level.index(at)] = brick.leaf_range[static_cast<std::size_t>(leaf)].high;
        }
      }
  });
  return level;
}

void HighestSamples::reach_along(int axis, Level& level) {
  const std::size_t stride = axis == 0   ? 1
                             : axis == 1 ? static_cast<std::size_t>(level.side)
                                         : level.index({0, 0, 1});
  const auto along = [&](int slow, int fast) {
    glm::ivec3 first(0);
    first[axis == 2 ? 1 : 2] = slow;
    first[axis == 0 ? 1 : 0] = fast;
    std::size_t i = level.index(first);
    for (int cube = 0; cube + 1 < level.side; ++cube, i += stride)
      level.high[i] = std::max(level.high[i], level.high[i + stride]);
  };
  tbb::parallel_for(0, level.side, [&](int slow) {
    for (int fast = 0; fast < level.side; ++fast) along(slow, fast);
  });
}

HighestSamples::Level HighestSamples::coarser(const Level& fine) {
  const int side = (fine.side + 3) / 4;
  const auto count = static_cast<std::size_t>(side);
  Level level{side,
              std::vector<std::int16_t>(count * count * count, std::numeric_limits<std::int16_t>::min())};
  tbb::parallel_for(0, side, [&](int slab) {
    for (int z = 4 * slab; z < std::min(fine.side, 4 * slab + 4); ++z)
      for (int y = 0; y < fine.side; ++y)
        for (int x = 0; x < fine.side; ++x) {
          std::int16_t& high = level.high[level.index(glm::ivec3(x, y, z) >> 2)];
          high = std::max(high, fine.at({x, y, z}));
        }
  });
  return level;
}

}  // namespace octotomy::voxel
