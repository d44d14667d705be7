// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/status_within.h"

#include <array>
#include <bit>
#include <cassert>
#include <optional>

namespace octotomy::voxel {
namespace {

// The children, each 2^child_log2 voxels a side, that a box overlaps. The box is in voxels of the block.
std::uint64_t children_within(const VoxelBox& box, int child_log2) {
  assert(glm::all(glm::greaterThanEqual(box.low, glm::ivec3(0))) &&
         glm::all(glm::lessThan(box.high >> child_log2, glm::ivec3(4))));
  static constexpr std::array<std::array<std::uint64_t, 4>, 3> planes{{
      {0x1111111111111111, 0x2222222222222222, 0x4444444444444444, 0x8888888888888888},
      {0x000f000f000f000f, 0x00f000f000f000f0, 0x0f000f000f000f00, 0xf000f000f000f000},
      {0x000000000000ffff, 0x00000000ffff0000, 0x0000ffff00000000, 0xffff000000000000},
  }};
  std::uint64_t within = all_children;
  for (int axis = 0; axis < 3; ++axis) {
    std::uint64_t slab = 0;
    for (int i = box.low[axis] >> child_log2; i <= box.high[axis] >> child_log2; ++i)
      slab |= planes[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
    within &= slab;
  }
  return within;
}

// The status of a box of voxels, whose coordinates are relative to the block around it.
Status status_within(BlockRef block, int height, const VoxelBox& box) {
  assert(glm::all(glm::lessThanEqual(box.low, box.high)));
  const Node* node = block.node();
  if (node == nullptr) return block.status();
  const int child_log2 = 2 * height - 2;
  const std::uint64_t within = children_within(box, child_log2);
  const std::uint64_t partial = within & node->partial;
  const bool some_full = (within & node->full) != 0;
  const bool some_empty = (within & ~node->full & ~node->partial) != 0;
  if (some_full && some_empty) return Status::Partial;
  if (partial == 0) return some_full ? Status::Full : Status::Empty;
  std::optional<Status> agreed;
  if (some_full) agreed = Status::Full;
  if (some_empty) agreed = Status::Empty;
  for (std::uint64_t rest = partial; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    const glm::ivec3 first = child_place(child) << child_log2;
    const VoxelBox part{glm::max(box.low - first, 0), glm::min(box.high - first, (1 << child_log2) - 1)};
    const Status status = height > 2
                              ? status_within(block.child(child), height - 1, part)
                              : status_of(children_within(part, 0), block.word(child), block.word(child));
    if (status == Status::Partial || (agreed && *agreed != status)) return Status::Partial;
    agreed = status;
  }
  return *agreed;
}

}  // namespace

Status status_within(const Octree& octree, const VoxelBox& box) {
  const int last = octree.universe().side() - 1;
  const VoxelBox clipped{glm::max(box.low, 0), glm::min(box.high, last)};
  if (glm::any(glm::greaterThan(clipped.low, clipped.high))) return Status::Empty;
  const Status status = status_within(octree.root(), octree.root_height(), clipped);
  const bool reaches_out = clipped.low != box.low || clipped.high != box.high;
  return reaches_out && status == Status::Full ? Status::Partial : status;
}

}  // namespace octotomy::voxel
