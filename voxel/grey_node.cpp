// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/grey_node.h"

#include <algorithm>
#include <cassert>

#include "voxel/level_tally.h"

namespace octotomy::voxel {
namespace {

glm::ivec3 octant(int number) {
  return {number & 1, (number >> 1) & 1, number >> 2};
}

void widen(MinMax& range, const MinMax& by) {
  range.low = std::min(range.low, by.low);
  range.high = std::max(range.high, by.high);
}

MinMax range_of_block(const GreyOctree& grey, const glm::ivec3& origin, int height) {
  if (height >= 2) return grey.range(height, origin >> (2 * height));
  const glm::ivec3 leaf = (origin >> 2) & 3;
  return grey.brick(origin >> 4).leaf_range[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))];
}

MinMax range_of_samples(const GreyOctree& grey, const glm::ivec3& origin, int side) {
  const std::int16_t first = grey.sample(origin);
  MinMax range{first, first};
  for (int k = 1; k < side * side * side; ++k) {
    const std::int16_t sample = grey.sample(origin + octant(k));
    widen(range, {sample, sample});
  }
  return range;
}

Status status_in(const MinMax& range, Window16 window) {
  if (range.low >= window.low && range.high <= window.high) return Status::Full;
  return range.high < window.low || range.low > window.high ? Status::Empty : Status::Partial;
}

class WindowCounter {
 public:
  WindowCounter(const GreyOctree& grey, Window16 window)
      : grey_(grey), window_(window), tally_(grey.universe().depth) {}
  void count_children(const glm::ivec3& origin, int side_log2) {
    const int child_log2 = side_log2 - 1;
    for (int number = 0; number < 8; ++number) {
      const glm::ivec3 child = origin + (octant(number) << child_log2);
      const MinMax range = range_of_node(grey_, child, child_log2);
      const Status status = status_in(range, window_);
      tally_.count(child_log2, status == Status::Full, status == Status::Empty);
      if (range.low != range.high) count_children(child, child_log2);
    }
  }
  std::vector<LevelCount> levels() const { return tally_.levels(); }

 private:
  const GreyOctree& grey_;
  Window16 window_;
  LevelTally tally_;
};

}  // namespace

MinMax range_of_node(const GreyOctree& grey, const glm::ivec3& origin, int side_log2) {
  if (side_log2 <= 1) return range_of_samples(grey, origin, 1 << side_log2);
  const bool is_block = side_log2 % 2 == 0;
  const int height = side_log2 / 2;  // of the block, or of the eight that the node is made of
  MinMax range = range_of_block(grey, origin, height);
  for (int number = 1; number < (is_block ? 1 : 8); ++number)
    widen(range, range_of_block(grey, origin + (octant(number) << (2 * height)), height));
  return range;
}

GreyNode::GreyNode(const GreyOctree& grey, Window16 window, const glm::ivec3& origin, int side_log2)
    : grey_(&grey),
      window_(window),
      origin_(origin),
      side_log2_(side_log2),
      status_(status_in(range_of_node(grey, origin, side_log2), window)) {}

GreyNode GreyNode::root(const GreyOctree& grey, Window16 window) {
  return {grey, window, glm::ivec3(0), grey.universe().depth};
}

GreyNode GreyNode::child(int number) const {
  assert(side_log2_ > 0 && number >= 0 && number < 8);
  return {*grey_, window_, origin_ + (octant(number) << (side_log2_ - 1)), side_log2_ - 1};
}

std::vector<LevelCount> level_counts(const GreyOctree& grey, Window16 window) {
  WindowCounter counter(grey, window);
  const MinMax all = range_of_node(grey, glm::ivec3(0), grey.universe().depth);
  if (all.low != all.high) counter.count_children(glm::ivec3(0), grey.universe().depth);
  return counter.levels();
}

}  // namespace octotomy::voxel
