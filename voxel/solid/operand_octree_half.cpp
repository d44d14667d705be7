// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/solid/status_within.h"
#include "voxel/tree/leaf_words.h"

namespace octotomy::voxel {
namespace {

// The number of points along a voxel's edge. It is odd so that no voxel has exactly half of its points
// inside. With 4, a face parallel to the grid would split the points evenly in one position out of four;
// counting such voxels as inside would grow an object by an eighth of a voxel at every move.
constexpr int points_an_axis = 5;

// The range of source voxels that may contain points of the voxels in a cube. Precondition: the cube contains
// these voxels' centres.
VoxelBox reached(const glm::dmat4& source_from_target, const Cube& cube) {
  const ImageBox box = image_of(source_from_target, {cube.centre, cube.half + 0.5});
  return {nearest_voxel(box.low), nearest_voxel(box.high)};
}

}  // namespace

HalfOctreeOperand::HalfOctreeOperand(const Octree& octree, const glm::dmat4& source_from_target)
    : octree_(&octree), source_from_target_(source_from_target) {
  const glm::dmat3 linear(source_from_target);
  std::size_t next = 0;
  for (int z = 0; z < points_an_axis; ++z)
    for (int y = 0; y < points_an_axis; ++y)
      for (int x = 0; x < points_an_axis; ++x)
        points_[next++] = linear * ((glm::dvec3(x, y, z) + 0.5) / static_cast<double>(points_an_axis) - 0.5);
  for (const glm::dvec3& point : points_) reach_ = glm::max(reach_, glm::abs(point));
}

Meets HalfOctreeOperand::meets(const Cube& cube) const {
  return Meets::of(status_within(*octree_, reached(source_from_target_, cube)));
}

void HalfOctreeOperand::words(const WantedLeaves& leaves) const {
  LeafWords region;
  for_each_wanted(leaves, [&](const glm::ivec3& origin) -> std::uint64_t {
    const VoxelBox box = reached(source_from_target_, {glm::dvec3(origin) + 1.5, 1.5});
    const glm::ivec3 first = box.low >> 2;
    const glm::ivec3 last = box.high >> 2;
    const bool near = glm::all(glm::lessThan(last - first, glm::ivec3(LeafWords::side)));
    if (near) {
      region.read(*octree_, first, last);
      if (region.any() == 0) return 0;
      if (region.every() == all_children) return all_children;
    }
    const auto holds = [&](const glm::ivec3& voxel) {
      if (!near) return octree_->contains(voxel);
      const glm::ivec3 leaf = (voxel >> 2) - first;
      const glm::ivec3 bit = voxel & 3;
      return ((region.word(leaf.x, leaf.y, leaf.z) >> child_index(bit.x, bit.y, bit.z)) & 1) != 0;
    };
    // For most voxels all source voxels within reach are inside, or all are outside. A few look-ups then
    // replace one look-up per point.
    const auto agreed = [&](const glm::ivec3& low, const glm::ivec3& high, bool inside) {
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x)
            if (holds({x, y, z}) != inside) return false;
      return true;
    };
    std::uint64_t word = 0;
    for (int voxel = 0; voxel < 64; ++voxel) {
      const glm::dvec3 p(source_from_target_ * glm::dvec4(glm::dvec3(origin + child_place(voxel)), 1.0));
      bool inside = holds(nearest_voxel(p));
      if (!agreed(nearest_voxel(p - reach_), nearest_voxel(p + reach_), inside)) {
        std::size_t count = 0;
        for (const glm::dvec3& point : points_) count += holds(nearest_voxel(p + point)) ? 1 : 0;
        inside = 2 * count > points_.size();
      }
      word |= std::uint64_t{inside} << voxel;
    }
    return word;
  });
}

}  // namespace octotomy::voxel
