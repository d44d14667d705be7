// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/voxel_boundary.h"

#include <bit>
#include <cstdint>
#include <oneapi/tbb/parallel_for.h>

#include "voxel/tree/octree_node.h"

namespace octotomy::verify {
namespace {

// The 4^3 voxels of a block as a word; blocks outside the universe are empty.
std::uint64_t word_at(const voxel::Octree& octree, const glm::ivec3& block) {
  const int blocks = octree.universe().side() / 4;
  if (glm::any(glm::lessThan(block, glm::ivec3(0))) ||
      glm::any(glm::greaterThanEqual(block, glm::ivec3(blocks))))
    return 0;
  voxel::BlockRef ref = octree.root();
  for (int height = octree.root_height(); height >= 2; --height) {
    const int shift = 2 * (height - 2);
    const int child =
        voxel::child_index((block.x >> shift) & 3, (block.y >> shift) & 3, (block.z >> shift) & 3);
    if (height == 2) return ref.word(child);
    ref = ref.child(child);
    if (ref.is_empty()) return 0;
    if (ref.is_full()) return voxel::all_children;
  }
  return 0;
}

// The voxels of a word whose neighbour at +axis or -axis is inside, given the word beyond that side.
std::uint64_t neighbours(std::uint64_t word, std::uint64_t beyond, int axis, int side) {
  constexpr std::uint64_t first_layer[3]{0x1111111111111111ULL, 0x000f000f000f000fULL, 0x000000000000ffffULL};
  const int step = 1 << (2 * axis);
  const std::uint64_t first = first_layer[axis], last = first << (3 * step);
  if (side > 0) return ((word & ~first) >> step) | ((beyond & first) << (3 * step));
  return ((word & ~last) << step) | ((beyond & last) >> (3 * step));
}

void append_faces(const voxel::Octree& octree, const glm::ivec3& block, std::vector<VoxelFace>& faces) {
  const std::uint64_t word = word_at(octree, block);
  if (word == 0) return;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      glm::ivec3 beyond = block;
      beyond[axis] += side;
      std::uint64_t exposed = word & ~neighbours(word, word_at(octree, beyond), axis, side);
      for (; exposed != 0; exposed &= exposed - 1) {
        const int bit = std::countr_zero(exposed);
        faces.push_back({block * 4 + glm::ivec3(bit & 3, (bit >> 2) & 3, bit >> 4), axis, side});
      }
    }
}

}  // namespace

std::vector<VoxelFace> voxel_boundary(const voxel::Octree& octree) {
  const int blocks = octree.universe().side() / 4;
  std::vector<std::vector<VoxelFace>> layers(static_cast<std::size_t>(blocks));
  tbb::parallel_for(0, blocks, [&](int z) {
    for (int y = 0; y < blocks; ++y)
      for (int x = 0; x < blocks; ++x) append_faces(octree, {x, y, z}, layers[static_cast<std::size_t>(z)]);
  });
  std::vector<VoxelFace> faces;
  for (const std::vector<VoxelFace>& layer : layers) faces.insert(faces.end(), layer.begin(), layer.end());
  return faces;
}

}  // namespace octotomy::verify
