// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/voxel_boundary.h"

#include <bit>
#include <cassert>
#include <cstdint>
#include <tbb/parallel_for.h>

#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

// The word of the leaf with the given index along each axis; 0 outside the universe.
std::uint64_t word_at(const Octree& octree, const glm::ivec3& leaf) {
  return octree.leaf_block(leaf >> 2).word(child_index(leaf.x & 3, leaf.y & 3, leaf.z & 3));
}

// A mask of the voxels of a word whose neighbour at +axis or -axis is inside the object; `beyond` is the word
// of the next leaf on that side.
std::uint64_t neighbours(std::uint64_t word, std::uint64_t beyond, int axis, int side) {
  assert(axis >= 0 && axis < 3 && (side == 1 || side == -1));
  constexpr std::uint64_t first_layer[3]{0x1111111111111111ULL, 0x000f000f000f000fULL, 0x000000000000ffffULL};
  const int step = 1 << (2 * axis);
  const std::uint64_t first = first_layer[axis], last = first << (3 * step);
  if (side > 0) return ((word & ~first) >> step) | ((beyond & first) << (3 * step));
  return ((word & ~last) << step) | ((beyond & last) >> (3 * step));
}

void append_faces(const Octree& octree, const glm::ivec3& leaf, std::vector<VoxelFace>& faces) {
  const std::uint64_t word = word_at(octree, leaf);
  if (word == 0) return;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      glm::ivec3 beyond = leaf;
      beyond[axis] += side;
      std::uint64_t exposed = word & ~neighbours(word, word_at(octree, beyond), axis, side);
      for (; exposed != 0; exposed &= exposed - 1)
        faces.push_back({leaf * 4 + child_place(std::countr_zero(exposed)), axis, side});
    }
}

// The edge, in leaves, of the largest empty block that contains a leaf; 0 if no block that contains it is
// empty.
int empty_edge(const Octree& octree, const glm::ivec3& leaf) {
  BlockRef block = octree.root();
  for (int height = octree.root_height(); block.node() != nullptr && height > 2; --height) {
    const glm::ivec3 child = (leaf >> (2 * height - 4)) & 3;
    block = block.child(child_index(child.x, child.y, child.z));
    if (block.is_empty()) return 1 << (2 * height - 4);
  }
  return block.is_empty() ? octree.universe().side() / 4 : 0;
}

}  // namespace

std::vector<VoxelFace> voxel_boundary(const Octree& octree) {
  const int leaves = octree.universe().side() / 4;
  std::vector<std::vector<VoxelFace>> layers(static_cast<std::size_t>(leaves));
  tbb::parallel_for(0, leaves, [&](int z) {
    for (int y = 0; y < leaves; ++y)
      for (int x = 0; x < leaves; ++x) {
        const int edge = x % 4 == 0 ? empty_edge(octree, {x, y, z}) : 0;
        if (edge > 0)
          x |= edge - 1;  // the next block begins at a multiple of the edge
        else
          append_faces(octree, {x, y, z}, layers[static_cast<std::size_t>(z)]);
      }
  });
  std::vector<VoxelFace> faces;
  for (const std::vector<VoxelFace>& layer : layers) faces.insert(faces.end(), layer.begin(), layer.end());
  return faces;
}

}  // namespace octotomy::voxel
