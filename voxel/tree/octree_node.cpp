// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/octree_node.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <new>

namespace octotomy::voxel {
namespace {

// The number of voxels in a block of a height. A block of height 6 has 2^36 voxels, so counts need 64 bits.
constexpr std::uint64_t voxels_of_height(int height) {
  return std::uint64_t{1} << (6 * height);
}

Node* allocate(int payload_count) {
  void* memory =
      ::operator new(sizeof(Node) + sizeof(std::uint64_t) * static_cast<std::size_t>(payload_count));
  return new (memory) Node;
}

void free_node(const Node* node) {
  node->~Node();
  ::operator delete(const_cast<Node*>(node));
}

}  // namespace

void retain(BlockRef block) {
  if (const Node* node = block.node()) node->references.fetch_add(1, std::memory_order_relaxed);
}

void release(BlockRef block) {
  const Node* node = block.node();
  if (node == nullptr || node->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  if (node->height > 2) {
    const int count = node->payload_count();
    for (int i = 0; i < count; ++i) prefetch_references(node->nodes()[i]);
    for (int i = 0; i < count; ++i) release(BlockRef::of(node->nodes()[i]));
  }
  free_node(node);
}

Block make_leaf_block(std::uint64_t full, std::uint64_t partial, const std::uint64_t* words) {
  assert((full & partial) == 0);
  std::array<std::uint64_t, 64> kept;
  std::uint64_t still_partial = 0;
  std::uint64_t voxel_count = 0;
  int count = 0;
  for (std::uint64_t rest = partial; rest != 0; rest &= rest - 1) {
    const std::uint64_t word = *words++;
    const std::uint64_t bit = rest & (~rest + 1);
    if (word == all_children) {
      full |= bit;
    } else if (word != 0) {
      still_partial |= bit;
      voxel_count += static_cast<std::uint64_t>(std::popcount(word));
      kept[static_cast<std::size_t>(count++)] = word;
    }
  }
  if (full == all_children) return Block::adopt(BlockRef::full());
  if (full == 0 && still_partial == 0) return {};
  Node* node = allocate(count);
  node->height = 2;
  node->full = full;
  node->partial = still_partial;
  node->voxel_count = voxel_count + 64 * static_cast<std::uint64_t>(std::popcount(full));
  std::copy_n(kept.begin(), count, node->words());
  return Block::adopt(BlockRef::of(node));
}

Block make_block(int height, std::uint64_t full, std::uint64_t undecided, std::span<BlockRef> children) {
  assert(height > 2 && (full & undecided) == 0);
  assert(children.size() == static_cast<std::size_t>(std::popcount(undecided)));
  std::uint64_t partial = 0;
  std::uint64_t voxel_count = 0;
  int count = 0;
  std::size_t next = 0;
  for (std::uint64_t rest = undecided; rest != 0; rest &= rest - 1) {
    const BlockRef child = children[next++];
    const std::uint64_t bit = rest & (~rest + 1);
    if (child.is_full()) {
      full |= bit;
    } else if (const Node* node = child.node()) {
      assert(node->height == height - 1);
      partial |= bit;
      voxel_count += node->voxel_count;
      children[static_cast<std::size_t>(count++)] = child;
    }
  }
  if (full == all_children) return Block::adopt(BlockRef::full());
  if (full == 0 && partial == 0) return {};
  Node* node = allocate(count);
  node->height = height;
  node->full = full;
  node->partial = partial;
  node->voxel_count =
      voxel_count + voxels_of_height(height - 1) * static_cast<std::uint64_t>(std::popcount(full));
  for (int i = 0; i < count; ++i) node->nodes()[i] = children[static_cast<std::size_t>(i)].node();
  return Block::adopt(BlockRef::of(node));
}

std::uint64_t voxel_count(BlockRef block, int height) {
  if (const Node* node = block.node()) return node->voxel_count;
  return block.is_full() ? voxels_of_height(height) : 0;
}

}  // namespace octotomy::voxel
