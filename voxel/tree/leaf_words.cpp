// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/leaf_words.h"

#include <cassert>

namespace octotomy::voxel {
void LeafWords::read(const Octree& octree, const glm::ivec3& first, const glm::ivec3& last) {
  assert(glm::all(glm::lessThan(last - first, glm::ivec3(side))));
  words_.fill(0);
  any_ = 0;
  every_ = all_children;
  const glm::ivec3 first_block = first >> 2;
  const glm::ivec3 last_block = last >> 2;
  for (int bz = first_block.z; bz <= last_block.z; ++bz)
    for (int by = first_block.y; by <= last_block.y; ++by)
      for (int bx = first_block.x; bx <= last_block.x; ++bx) {
        const BlockRef block = octree.leaf_block({bx, by, bz});
        if (block.is_empty()) {
          every_ = 0;
          continue;
        }
        const glm::ivec3 origin = 4 * glm::ivec3(bx, by, bz);
        const glm::ivec3 low = glm::max(first, origin);
        const glm::ivec3 high = glm::min(last, origin + 3);
        for (int z = low.z; z <= high.z; ++z)
          for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) {
              const std::uint64_t word = block.word(child_index(x & 3, y & 3, z & 3));
              any_ |= word;
              every_ &= word;
              words_[static_cast<std::size_t>((x - first.x) +
                                              side * ((y - first.y) + side * (z - first.z)))] = word;
            }
      }
}

}  // namespace octotomy::voxel
