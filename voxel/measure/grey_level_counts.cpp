// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/grey_level_counts.h"

#include <cassert>

#include "voxel/tree/grey_node.h"
#include "voxel/tree/level_tally.h"

namespace octotomy::voxel {
namespace {

class GreyCounter {
 public:
  explicit GreyCounter(const GreyOctree& grey) : grey_(grey), tally_(grey.universe().depth) {}

  // Counts the eight children of a Partial node, a cube of 2^side_log2 voxels a side.
  void count_children(const glm::ivec3& origin, int side_log2) {
    assert(side_log2 > 0);  // a voxel has only one sample, so it cannot be Partial
    for (int k = 0; k < 8; ++k) {
      const int child_log2 = side_log2 - 1;
      const glm::ivec3 child = origin + (glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) << child_log2);
      const MinMax range = range_of_node(grey_, child, child_log2);
      const bool alike = range.low == range.high, is_background = range.low == grey_.background();
      if (tally_.count(child_log2, alike && !is_background, alike && is_background))
        count_children(child, child_log2);
    }
  }

  std::vector<LevelCount> levels() const { return tally_.levels(); }

 private:
  const GreyOctree& grey_;
  LevelTally tally_;
};

}  // namespace

std::vector<LevelCount> level_counts(const GreyOctree& grey) {
  GreyCounter counter(grey);
  const int depth = grey.universe().depth;
  const MinMax range = range_of_node(grey, glm::ivec3(0), depth);
  if (range.low != range.high) counter.count_children(glm::ivec3(0), depth);
  return counter.levels();
}

}  // namespace octotomy::voxel
