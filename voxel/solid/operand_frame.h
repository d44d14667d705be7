// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "voxel/solid/operand.h"
#include "voxel/tree/octree_node.h"

// What the operands' sources share: children and voxels of a block, and how far a linear map strays over
// them.

namespace octotomy::voxel {

/// Cover of a block from the status of each child, asked by the child's centre (of its voxels' centres).
template <typename ChildStatus>
Cover cover_of_children(const TargetBlock& block, const ChildStatus& child_status) {
  Cover cover;
  const double to_centre = 0.5 * (block.child_side - 1);
  for (int child = 0; child < 64; ++child) {
    const glm::dvec3 centre = glm::dvec3(block.origin + child_place(child) * block.child_side) + to_centre;
    const Status status = child_status(centre);
    const std::uint64_t bit = std::uint64_t{1} << child;
    if (status == Status::Full) cover.full |= bit;
    if (status != Status::Empty) cover.some |= bit;
  }
  return cover;
}

/// Words of the wanted leaves from the word of a leaf at its first voxel.
template <typename Leaf>
void for_each_wanted(const WantedLeaves& leaves, const Leaf& leaf) {
  for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    leaves.words[child] = leaf(leaves.origin + 4 * child_place(child));
  }
}

/// The same from whether each voxel's centre is inside.
template <typename Inside>
void for_each_wanted_voxel(const WantedLeaves& leaves, const Inside& inside) {
  for_each_wanted(leaves, [&](const glm::ivec3& origin) {
    std::uint64_t word = 0;
    for (int voxel = 0; voxel < 64; ++voxel)
      word |= std::uint64_t{inside(glm::dvec3(origin + child_place(voxel)))} << voxel;
    return word;
  });
}

/// How far f may stray from its value at a child's centre over the centres of the child's voxels, with what
/// rounding could add: the walk must leave to the words what rounding could decide either way, or the answer
/// would depend on the tree's shape.
double reach(const Linear& f, int child_side);

/// Row `row` of an affine map, and the map followed by a projection onto a direction, less an offset.
Linear component(const glm::dmat4& map, int row);
Linear along(const glm::dmat4& map, const glm::dvec3& direction, double offset);

/// The box in another frame that holds the centres of a child's voxels.
struct ImageBox {
  glm::dvec3 low, high;
};
class Imager {
 public:
  Imager(const glm::dmat4& map, int child_side) : map_(map) {
    for (int row = 0; row < 3; ++row) half_[row] = reach(component(map, row), child_side);
  }
  ImageBox operator()(const glm::dvec3& centre) const {
    const glm::dvec3 p(map_ * glm::dvec4(centre, 1.0));
    return {p - half_, p + half_};
  }

 private:
  glm::dmat4 map_;
  glm::dvec3 half_{0.0};
};

/// Voxels, both ends included.
struct VoxelBox {
  glm::ivec3 low, high;
};

}  // namespace octotomy::voxel
