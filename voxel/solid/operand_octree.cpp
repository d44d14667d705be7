// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/solid/status_within.h"
#include "voxel/space/vector_clones.h"
#include "voxel/tree/leaf_words.h"

namespace octotomy::voxel {

Meets ShiftedOctreeOperand::meets(const Cube& cube) const {
  assert(cube.half > 0.0);
  const glm::ivec3 low = nearest_voxel(cube.centre - cube.half);
  const glm::ivec3 high(glm::ceil(cube.centre + cube.half - 0.5));
  const Meets meets = Meets::of(status_within(*octree_, {low + source_offset_, high + source_offset_}));
  return meets.decided() ? meets : Meets::exactly(true, true);
}

bool ShiftedOctreeOperand::contains(const glm::dvec3& p_voxel) const {
  return octree_->contains(nearest_voxel(p_voxel) + source_offset_);
}

void ShiftedOctreeOperand::words(const WantedLeaves& leaves) const {
  const ShiftedLeaves from(leaves.origin + source_offset_);
  LeafWords region;
  region.read(*octree_, from.first, from.last);
  region.shifted(from.shift, leaves.words);
}

namespace {

// Fixed-point numbers within a region of 32 voxels along each axis: 5 bits for voxels and 24 bits for the
// fraction lie below the sign bit.
constexpr int fraction_bits = 24;

// More than the error of the sum of a base and an offset, each of which is rounded by at most half a unit.
const double fixed_slack = std::ldexp(1.0, 1 - fraction_bits);

std::int32_t fixed(double voxels) {
  constexpr double unit = 1 << fraction_bits;
  return static_cast<std::int32_t>(std::floor(voxels * unit + 0.5));
}

glm::ivec3 fixed(const glm::dvec3& p) {
  return {fixed(p.x), fixed(p.y), fixed(p.z)};
}

/// A leaf's word from the words of a region's leaves. Voxel i of the leaf lies at base + offsets[i] in the
/// region.
OCTOTOMY_VECTOR_CLONES std::uint64_t looked_up(const std::uint64_t* words, const glm::ivec3& base,
                                               const std::array<std::array<std::int32_t, 64>, 3>& offsets) {
  // The positions are computed before the look-ups, because the compiler vectorises this arithmetic.
  std::array<std::uint64_t, 64> place;
  for (std::size_t i = 0; i < 64; ++i) {
    const auto x = static_cast<std::uint32_t>(base.x + offsets[0][i]) >> fraction_bits;
    const auto y = static_cast<std::uint32_t>(base.y + offsets[1][i]) >> fraction_bits;
    const auto z = static_cast<std::uint32_t>(base.z + offsets[2][i]) >> fraction_bits;
    const std::uint32_t leaf_number = (x >> 2) | ((y >> 2) << 3) | ((z >> 2) << 6);
    const std::uint32_t bit = (x & 3) | ((y & 3) << 2) | ((z & 3) << 4);
    place[i] = leaf_number << 6 | bit;
  }
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < 64; ++i) word |= ((words[place[i] >> 6] >> (place[i] & 63)) & 1) << i;
  return word;
}

}  // namespace

SampledOctreeOperand::SampledOctreeOperand(const Octree& octree, const glm::dmat4& source_from_target)
    : octree_(&octree), source_from_target_(source_from_target) {
  const glm::dmat3 linear(source_from_target);
  // If the source is much finer than the target, offsets exceed the range of the fixed-point numbers; words()
  // then does not use them.
  const double longest = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  if (longest > 4.0) return;
  for (int voxel = 0; voxel < 64; ++voxel) {
    const glm::ivec3 offset = fixed(linear * glm::dvec3(child_place(voxel)));
    lowest_ = glm::min(lowest_, offset);
    highest_ = glm::max(highest_, offset);
    for (int axis = 0; axis < 3; ++axis)
      offsets_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(voxel)] = offset[axis];
  }
}

Meets SampledOctreeOperand::meets(const Cube& cube) const {
  const ImageBox box = image_of(source_from_target_, cube);
  return Meets::of(status_within(*octree_, {nearest_voxel(box.low), nearest_voxel(box.high)}));
}

bool SampledOctreeOperand::contains(const glm::dvec3& p_voxel) const {
  return octree_->contains(nearest_voxel(glm::dvec3(source_from_target_ * glm::dvec4(p_voxel, 1.0))));
}

// Fetches the source leaves around the block once. Each wanted leaf is then looked up voxel by voxel in them,
// unless the leaves around it are all full or all empty.
void SampledOctreeOperand::words(const WantedLeaves& leaves) const {
  const ImageBox box = image_of(source_from_target_, TargetBlock{leaves.origin, 4}.whole());
  const glm::ivec3 first = nearest_voxel(box.low - fixed_slack) >> 2;
  const glm::ivec3 last = nearest_voxel(box.high + fixed_slack) >> 2;
  if (glm::any(glm::greaterThanEqual(last - first, glm::ivec3(LeafWords::side))))
    return for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) { return contains(voxel); });
  LeafWords region;
  region.read(*octree_, first, last);
  if (region.any() == 0 || region.every() == all_children)
    return for_each_wanted(leaves, [&](const glm::ivec3&) { return region.every(); });
  for_each_wanted(leaves, [&](const glm::ivec3& origin) {
    const glm::dvec3 p(source_from_target_ * glm::dvec4(glm::dvec3(origin), 1.0));
    // Half a voxel is added, so that truncation rounds to the nearest voxel.
    return leaf(region, fixed(p - glm::dvec3(4 * first) + 0.5));
  });
}

std::uint64_t SampledOctreeOperand::leaf(const LeafWords& region, const glm::ivec3& base) const {
  assert(glm::all(glm::greaterThanEqual(base + lowest_, glm::ivec3(0))));
  const glm::ivec3 first = (base + lowest_) >> (fraction_bits + 2);
  const glm::ivec3 last = (base + highest_) >> (fraction_bits + 2);
  std::uint64_t any = 0;
  std::uint64_t every = all_children;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        any |= region.word(x, y, z);
        every &= region.word(x, y, z);
      }
  if (any == 0) return 0;
  if (every == all_children) return all_children;
  return looked_up(region.words(), base, offsets_);
}

}  // namespace octotomy::voxel
