// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "voxel/operand.h"
#include "voxel/operand_frame.h"

namespace octotomy::voxel {
namespace {

Status status_of_range(const MinMax& range, double low, double high) {
  if (range.low >= low && range.high <= high) return Status::Full;
  return range.high < low || range.low > high ? Status::Empty : Status::Mixed;
}

// Range of samples over a box of voxels, from blocks of 16 voxels a side.
MinMax range_within(const GreyOctree& grey, const VoxelBox& box) {
  const int last = grey.universe().side() - 1;
  const VoxelBox clipped{glm::clamp(box.low, 0, last), glm::clamp(box.high, 0, last)};
  // The coarsest height at which the box still spans at most three blocks an axis keeps the work bounded.
  int height = 2;
  const glm::ivec3 extent = clipped.high - clipped.low;
  while ((std::max({extent.x, extent.y, extent.z}) >> (2 * height)) > 2) ++height;
  height = std::min(height, root_height(grey.universe().depth));
  const glm::ivec3 first = clipped.low >> (2 * height);
  const glm::ivec3 final = clipped.high >> (2 * height);
  MinMax range = grey.range(height, first);
  for (int z = first.z; z <= final.z; ++z)
    for (int y = first.y; y <= final.y; ++y)
      for (int x = first.x; x <= final.x; ++x) {
        const MinMax& part = grey.range(height, {x, y, z});
        range.low = std::min(range.low, part.low);
        range.high = std::max(range.high, part.high);
      }
  if (clipped.low != box.low || clipped.high != box.high) {
    range.low = std::min(range.low, grey.background());
    range.high = std::max(range.high, grey.background());
  }
  return range;
}

double interpolate(const GreyOctree& grey, const glm::dvec3& p) {
  const glm::dvec3 cell = glm::floor(p);
  const glm::ivec3 low(cell);
  const glm::dvec3 t = p - cell;
  const auto along_x = [&](int y, int z) {
    return grey.sample(low + glm::ivec3(0, y, z)) * (1.0 - t.x) +
           grey.sample(low + glm::ivec3(1, y, z)) * t.x;
  };
  const double below = along_x(0, 0) * (1.0 - t.y) + along_x(1, 0) * t.y;
  const double above = along_x(0, 1) * (1.0 - t.y) + along_x(1, 1) * t.y;
  return below * (1.0 - t.z) + above * t.z;
}

}  // namespace

Cover WindowOperand::cover(const TargetBlock& block) const {
  Cover cover;
  const int child_height = std::bit_width(static_cast<unsigned>(block.child_side)) / 2;
  const glm::ivec3 first = block.origin / block.child_side;
  const int side = grey_->universe().side();
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 place = child_place(child);
    if (glm::any(glm::greaterThanEqual(block.origin + place * block.child_side, glm::ivec3(side)))) continue;
    const MinMax range = child_height == 1
                             ? grey_->brick(block.origin >> 4).leaf_range[static_cast<std::size_t>(child)]
                             : grey_->range(child_height, first + place);
    const Status status = status_of_range(range, window_.low, window_.high);
    const std::uint64_t bit = std::uint64_t{1} << child;
    if (status == Status::Full) cover.full |= bit;
    if (status != Status::Empty) cover.some |= bit;
  }
  return cover;
}

void WindowOperand::words(const WantedLeaves& leaves) const {
  const GreyBrick& brick = grey_->brick(leaves.origin >> 4);
  for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    leaves.words[child] = window_bits64(brick.samples[static_cast<std::size_t>(child)].data(), window_);
  }
}

Cover SampledWindowOperand::cover(const TargetBlock& block) const {
  const Imager image(source_from_target_, block.child_side);
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const ImageBox box = image(centre);
    const VoxelBox voxels{glm::ivec3(glm::floor(box.low)), glm::ivec3(glm::floor(box.high)) + 1};
    return status_of_range(range_within(window_->grey, voxels), window_->low, window_->high);
  });
}

void SampledWindowOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) {
    const double value = interpolate(window_->grey, glm::dvec3(source_from_target_ * glm::dvec4(voxel, 1.0)));
    return value >= window_->low && value <= window_->high;
  });
}

}  // namespace octotomy::voxel
