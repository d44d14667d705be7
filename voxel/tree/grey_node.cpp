// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_node.h"

#include <algorithm>
#include <cassert>

#include "voxel/tree/level_tally.h"

namespace octotomy::voxel {
namespace {

glm::ivec3 octant(int number) {
  return {number & 1, (number >> 1) & 1, number >> 2};
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
    range.widen({sample, sample});
  }
  return range;
}

class WindowCounter {
 public:
  WindowCounter(const GreyOctree& grey, Window16 window)
      : grey_(grey), window_(window), tally_(grey.universe().depth) {}
  void count_children(const GreyNode& node, const glm::ivec3& origin) {
    const int child_log2 = node.side_log2() - 1;
    for (int number = 0; number < 8; ++number) {
      const glm::ivec3 at = origin + (octant(number) << child_log2);
      const GreyNode child = node.child(number);
      tally_.count(child_log2, child.status() == Status::Full, child.status() == Status::Empty);
      if (has_children(child, at)) count_children(child, at);
    }
  }
  void count(const GreyNode& root) {
    if (has_children(root, glm::ivec3(0))) count_children(root, glm::ivec3(0));
  }
  std::vector<LevelCount> levels() const { return tally_.levels(); }

 private:
  bool has_children(const GreyNode& node, const glm::ivec3& origin) const {
    if (node.side_log2() == 0) return false;
    const MinMax range = range_of_node(grey_, origin, node.side_log2());
    return range.low != range.high || node.status() == Status::Partial;
  }

  const GreyOctree& grey_;
  Window16 window_;
  LevelTally tally_;
};

}  // namespace

MinMax range_of_node(const GreyOctree& grey, const glm::ivec3& origin, int side_log2) {
  if (side_log2 <= 1) return range_of_samples(grey, origin, 1 << side_log2);
  const bool is_block = side_log2 % 2 == 0;
  // Range of the samples of the block, or of the eight blocks that form the node.
  const int height = side_log2 / 2;
  MinMax range = range_of_block(grey, origin, height);
  for (int number = 1; number < (is_block ? 1 : 8); ++number)
    range.widen(range_of_block(grey, origin + (octant(number) << (2 * height)), height));
  return range;
}

GreyNode::GreyNode(const GreyOctree& grey, Window16 window, const glm::ivec3& origin, const LogicalNode& scan)
    : grey_(&grey),
      window_(window),
      origin_(origin),
      scan_(scan),
      status_(window_status(range_of_node(grey, origin, scan.side_log2()), window.low, window.high)) {
  // If the window excludes the background, it excludes all voxels beyond the scan, so the range alone
  // decides.
  if (status_ == Status::Empty || !grey.window_meets_background(window.low, window.high)) return;
  const Status scanned = scan.status();
  if (scanned != Status::Full) status_ = scanned;
}

GreyNode GreyNode::root(const GreyOctree& grey, Window16 window) {
  return {grey, window, glm::ivec3(0), LogicalNode::root(grey.scan())};
}

GreyNode GreyNode::child(int number) const {
  assert(side_log2() > 0 && number >= 0 && number < 8);
  return {*grey_, window_, origin_ + (octant(number) << (side_log2() - 1)), scan_.child(number)};
}

std::vector<LevelCount> level_counts(const GreyOctree& grey, Window16 window) {
  WindowCounter counter(grey, window);
  counter.count(GreyNode::root(grey, window));
  return counter.levels();
}

}  // namespace octotomy::voxel
