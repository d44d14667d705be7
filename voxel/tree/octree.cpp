// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/octree.h"

#include <array>
#include <bit>
#include <unordered_set>

#include "voxel/tree/level_tally.h"
#include "voxel/tree/octant_order.h"

namespace octotomy::voxel {
namespace {

// Counts the nodes of the logical octree by level and status.
class LevelCounter {
 public:
  explicit LevelCounter(int depth) : tally_(depth) {}

  // Counts the two levels below a Partial block: its 8 octants, and the 8 children of each Partial octant.
  void count_children(BlockRef block, int height) {
    const Node& node = *block.node();
    for (int octant_number = 0; octant_number < 8; ++octant_number) {
      const std::uint64_t mask = octant_mask(octant_number);
      if (!tally_.count(2 * height - 1, (node.full & mask) == mask, ((node.full | node.partial) & mask) == 0))
        continue;
      count_octant(block, height, mask);
    }
  }

  // Counts the 8 children of a Partial octant of a block.
  void count_octant(BlockRef block, int height, std::uint64_t mask) {
    const Node& node = *block.node();
    for (std::uint64_t rest = mask; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      const std::uint64_t bit = rest & (~rest + 1);
      if (!tally_.count(2 * height - 2, (node.full & bit) != 0, ((node.full | node.partial) & bit) == 0))
        continue;
      if (height > 2)
        count_children(block.child(child), height - 1);
      else
        count_word(block.word(child));
    }
  }

  // Counts the two levels within a Partial leaf.
  void count_word(std::uint64_t word) {
    for (int octant_number = 0; octant_number < 8; ++octant_number)
      count_word_octant(word, octant_mask(octant_number));
  }
  void count_word_octant(std::uint64_t word, std::uint64_t mask) {
    if (tally_.count(1, (word & mask) == mask, (word & mask) == 0)) tally_.count_voxels(word, mask);
  }

  std::vector<LevelCount> levels() const { return tally_.levels(); }

 private:
  LevelTally tally_;
};

std::uint64_t bytes_below(const Node* node, std::unordered_set<const Node*>& met) {
  // Only nodes with several owners can be reached twice, so only these are remembered.
  if (node->references.load(std::memory_order_relaxed) > 1 && !met.insert(node).second) return 0;
  std::uint64_t bytes =
      sizeof(Node) + sizeof(std::uint64_t) * static_cast<std::uint64_t>(node->payload_count());
  if (node->height > 2)
    for (int i = 0; i < node->payload_count(); ++i) bytes += bytes_below(node->nodes()[i], met);
  return bytes;
}

bool equal(BlockRef a, BlockRef b) {
  if (a == b) return true;
  const Node* left = a.node();
  const Node* right = b.node();
  if (left == nullptr || right == nullptr) return false;
  if (left->voxel_count != right->voxel_count || left->full != right->full || left->partial != right->partial)
    return false;
  for (int i = 0; i < left->payload_count(); ++i) {
    const bool same = left->height == 2
                          ? left->words()[i] == right->words()[i]
                          : equal(BlockRef::of(left->nodes()[i]), BlockRef::of(right->nodes()[i]));
    if (!same) return false;
  }
  return true;
}

}  // namespace

std::uint64_t universe_children(int depth) {
  if (depth == 2) return 1;
  return depth % 2 == 0 ? all_children : octant_children;
}

Octree Octree::full(const Universe& universe) {
  const std::uint64_t children = universe_children(universe.depth);
  const int height = octotomy::voxel::root_height(universe.depth);
  return {universe,
          height == 2 ? make_leaf_block(children, 0, nullptr) : make_block(height, children, 0, {})};
}

std::uint64_t Octree::voxel_count() const {
  return octotomy::voxel::voxel_count(root(), root_height());
}

BlockRef Octree::leaf_block(const glm::ivec3& number) const {
  const int count = (universe_.side() + 15) / 16;
  if (glm::any(glm::lessThan(number, glm::ivec3(0))) ||
      glm::any(glm::greaterThanEqual(number, glm::ivec3(count))))
    return {};
  BlockRef block = root();
  for (int height = root_height(); height > 2 && block.node() != nullptr; --height) {
    const glm::ivec3 child = (number >> (2 * height - 6)) & 3;
    block = block.child(child_index(child.x, child.y, child.z));
  }
  return block;
}

bool Octree::contains(const glm::ivec3& voxel) const {
  const glm::ivec3 leaf = (voxel >> 2) & 3;
  const glm::ivec3 bit = voxel & 3;
  return glm::all(glm::lessThan(voxel, glm::ivec3(universe_.side()))) &&
         ((leaf_block(voxel >> 4).word(child_index(leaf.x, leaf.y, leaf.z)) >>
           child_index(bit.x, bit.y, bit.z)) &
          1) != 0;
}

bool Octree::operator==(const Octree& other) const {
  return universe_ == other.universe_ && equal(root(), other.root());
}

std::vector<LevelCount> level_counts(const Octree& octree) {
  const int depth = octree.universe().depth;
  const int height = octree.root_height();
  LevelCounter counter(depth);
  const std::uint64_t count = octree.voxel_count();
  const auto side = static_cast<std::uint64_t>(octree.universe().side());
  if (count != 0 && count != side * side * side) {
    if (depth == 2)
      counter.count_word(octree.root().word(0));
    else if (depth % 2 == 1)
      counter.count_octant(octree.root(), height, octant_children);
    else
      counter.count_children(octree.root(), height);
  }
  return counter.levels();
}

std::uint64_t bytes_memory(const Octree& octree) {
  std::unordered_set<const Node*> met;
  const Node* root = octree.root().node();
  return root == nullptr ? 0 : bytes_below(root, met);
}

}  // namespace octotomy::voxel
