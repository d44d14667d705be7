// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/grey_level_counts.h"

#include <algorithm>
#include <cassert>

#include "voxel/octree_node.h"

namespace octotomy::voxel {
namespace {

void widen(MinMax& range, const MinMax& by) {
  range.low = std::min(range.low, by.low);
  range.high = std::max(range.high, by.high);
}

class GreyCounter {
 public:
  explicit GreyCounter(const GreyOctree& grey)
      : grey_(grey), by_side_(static_cast<std::size_t>(grey.universe().depth) + 1) {}

  // Counts the eight children of a Partial node, a cube of 2^side_log2 voxels a side.
  void count_children(const glm::ivec3& origin, int side_log2) {
    assert(side_log2 > 0);  // a voxel has one sample
    for (int k = 0; k < 8; ++k) {
      const int child_log2 = side_log2 - 1;
      const glm::ivec3 child = origin + (glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << child_log2);
      const MinMax range = range_of(child, child_log2);
      LevelCount& level = by_side_[static_cast<std::size_t>(child_log2)];
      if (range.low != range.high) {
        ++level.partial;
        count_children(child, child_log2);
      } else {
        ++(range.low == grey_.background() ? level.empty : level.full);
      }
    }
  }

  MinMax range_of(const glm::ivec3& origin, int side_log2) const {
    if (side_log2 <= 1) return range_of_samples(origin, 1 << side_log2);
    const bool is_block = side_log2 % 2 == 0;
    const int height = side_log2 / 2;  // of the block, or of the eight that the node is made of
    MinMax range = range_of_block(origin, height);
    for (int k = 1; k < (is_block ? 1 : 8); ++k)
      widen(range,
            range_of_block(origin + (glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << (2 * height)), height));
    return range;
  }

  std::vector<LevelCount> levels() const {
    const int depth = grey_.universe().depth;
    std::vector<LevelCount> result;
    for (int level = 1; level <= depth; ++level) {
      result.push_back(by_side_[static_cast<std::size_t>(depth - level)]);
      result.back().level = level;
    }
    return result;
  }

 private:
  MinMax range_of_block(const glm::ivec3& origin, int height) const {
    if (height > 1) return grey_.range(height, origin >> (2 * height));
    const glm::ivec3 leaf = (origin >> 2) & 3;
    return grey_.brick(origin >> 4).leaf_range[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))];
  }
  MinMax range_of_samples(const glm::ivec3& origin, int side) const {
    MinMax range{grey_.sample(origin), grey_.sample(origin)};
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const std::int16_t sample = grey_.sample(origin + glm::ivec3(x, y, z));
          widen(range, {sample, sample});
        }
    return range;
  }

  const GreyOctree& grey_;
  std::vector<LevelCount> by_side_;
};

}  // namespace

std::vector<LevelCount> level_counts(const GreyOctree& grey) {
  GreyCounter counter(grey);
  const int depth = grey.universe().depth;
  const MinMax range = counter.range_of(glm::ivec3(0), depth);
  if (range.low != range.high) counter.count_children(glm::ivec3(0), depth);
  return counter.levels();
}

}  // namespace octotomy::voxel
