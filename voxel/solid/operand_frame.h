// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "voxel/solid/operand.h"
#include "voxel/tree/octree_node.h"

// Shared by the sources of the operands: loops over a block's children and voxels, and bounds of linear maps
// over a cube.

namespace octotomy::voxel {

/// The cover of a block, computed by meets() for the cube of each child.
template <typename ChildMeets>
Cover cover_of_children(const TargetBlock& block, const ChildMeets& child_meets) {
  Cover cover;
  for (int child = 0; child < 64; ++child) {
    const Meets meets = child_meets(block.child(child));
    const std::uint64_t bit = std::uint64_t{1} << child;
    if (!meets.out) cover.full |= bit;
    if (meets.in) cover.some |= bit;
  }
  return cover;
}

/// Computes the words of the wanted leaves. `leaf(first_voxel)` returns a leaf's word.
template <typename Leaf>
void for_each_wanted(const WantedLeaves& leaves, const Leaf& leaf) {
  for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    leaves.words[child] = leaf(leaves.origin + 4 * child_place(child));
  }
}

/// Computes the words of the wanted leaves. `inside` returns whether a voxel's centre is inside.
template <typename Inside>
void for_each_wanted_voxel(const WantedLeaves& leaves, const Inside& inside) {
  for_each_wanted(leaves, [&](const glm::ivec3& origin) {
    std::uint64_t word = 0;
    for (int voxel = 0; voxel < 64; ++voxel)
      word |= std::uint64_t{inside(glm::dvec3(origin + child_place(voxel)))} << voxel;
    return word;
  });
}

/// A bound for the difference between f in a cube and f at the cube's centre, rounding included. A walk must
/// not decide a block if rounding could change the answer at one of its voxels; otherwise the result would
/// depend on the tree's shape.
double reach(const Linear& f, double half);

/// component(): row `row` of an affine map. along(): the map's image projected onto a direction, minus
/// `offset`.
Linear component(const glm::dmat4& map, int row);
Linear along(const glm::dmat4& map, const glm::dvec3& direction, double offset);

/// A box in another frame that contains the image of a cube.
struct ImageBox {
  glm::dvec3 low, high;
};
inline ImageBox image_of(const glm::dmat4& map, const Cube& cube) {
  const glm::dvec3 p(map * glm::dvec4(cube.centre, 1.0));
  glm::dvec3 half;
  for (int row = 0; row < 3; ++row) half[row] = reach(component(map, row), cube.half);
  return {p - half, p + half};
}

/// The voxel that contains a point in index space.
inline glm::ivec3 nearest_voxel(const glm::dvec3& p_voxel) {
  return glm::ivec3(glm::floor(p_voxel + 0.5));
}

/// Voxels, both ends included.
struct VoxelBox {
  glm::ivec3 low, high;
};

/// The source leaves first..last that a block of height 2 overlaps under a translation by whole voxels. The
/// block begins `shift` voxels into leaf `first`. `source` is the block's first voxel in the source.
struct ShiftedLeaves {
  explicit ShiftedLeaves(const glm::ivec3& source)
      : first(source >> 2),
        shift(source & 3),
        last(first + 3 + glm::ivec3(glm::notEqual(shift, glm::ivec3(0)))) {}
  glm::ivec3 first, shift, last;
};

}  // namespace octotomy::voxel
