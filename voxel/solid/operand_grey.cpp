// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/tree/leaf_words.h"

namespace octotomy::voxel {
namespace {

// The range of the samples in a box of voxels, from the stored ranges of blocks of at least 16 voxels a side,
// so it may be too wide.
MinMax range_within(const GreyOctree& grey, const VoxelBox& box) {
  const int last = grey.universe().side() - 1;
  const VoxelBox clipped{glm::clamp(box.low, 0, last), glm::clamp(box.high, 0, last)};
  // The least height at which the box spans at most four blocks along each axis, which bounds the work.
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
        range.widen(part);
      }
  if (clipped.low != box.low || clipped.high != box.high) range.widen({grey.background(), grey.background()});
  return range;
}

// The box of samples on which values within the image of a cube may depend.
VoxelBox support(const glm::dmat4& source_from_target, const Cube& cube, Interpolation interpolation) {
  const ImageBox box = image_of(source_from_target, cube);
  const Margin around = margin(interpolation);
  return {glm::ivec3(glm::floor(box.low)) - around.before, glm::ivec3(glm::floor(box.high)) + around.after};
}

double value_at(const GreyOctree& grey, const glm::dvec3& position, Interpolation interpolation) {
  return interpolation == Interpolation::Linear ? interpolate_scan(grey, position)
                                                : interpolate(grey, position, interpolation);
}

// A copy of the samples around one leaf, from up to 4 leaves along each axis.
class NearSamples {
 public:
  static constexpr int leaves = 4;
  static constexpr int side = 4 * leaves;

  // Selects the leaves first..last, both included, and returns the range of their samples.
  MinMax choose(const GreyOctree& grey, const glm::ivec3& first, const glm::ivec3& last) {
    first_ = first;
    count_ = last - first + 1;
    assert(glm::all(glm::greaterThan(count_, glm::ivec3(0))) &&
           glm::all(glm::lessThanEqual(count_, glm::ivec3(leaves))));
    MinMax range{std::numeric_limits<std::int16_t>::max(), std::numeric_limits<std::int16_t>::min()};
    const int limit = grey.universe().side() / 4;
    std::size_t next = 0;
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
          const bool outside = x < 0 || y < 0 || z < 0 || x >= limit || y >= limit || z >= limit;
          const glm::ivec3 leaf(x, y, z);
          const auto number = static_cast<std::size_t>(child_index(x & 3, y & 3, z & 3));
          const GreyBrick* brick = outside ? nullptr : &grey.brick(leaf >> 2);
          chosen_[next++] = brick == nullptr ? nullptr : brick->samples[number].data();
          const MinMax part =
              brick == nullptr ? MinMax{grey.background(), grey.background()} : brick->leaf_range[number];
          range.widen(part);
        }
    return range;
  }

  // Copies the selected leaves' samples.
  void fetch(std::int16_t background) {
    std::size_t next = 0;
    for (int z = 0; z < count_.z; ++z)
      for (int y = 0; y < count_.y; ++y)
        for (int x = 0; x < count_.x; ++x) {
          const std::int16_t* source = chosen_[next++];
          for (int row = 0; row < 16; ++row) {
            std::int16_t* target = &samples_[index(4 * x, 4 * y + (row & 3), 4 * z + (row >> 2))];
            if (source == nullptr)
              std::fill_n(target, 4, background);
            else
              std::copy_n(source + 4 * row, 4, target);
          }
        }
  }

  // The value at a position of the source. Linear interpolation returns none if one of its samples equals the
  // background. Samples beyond the scan do, and must not be mixed with measured ones.
  std::optional<double> interpolate(const glm::dvec3& position, Interpolation interpolation,
                                    std::int16_t background) const {
    if (interpolation == Interpolation::Linear) return trilinear(position, background);
    const glm::dvec3 p = position - glm::dvec3(4 * first_);
    const Stencil x = stencil(p.x, interpolation);
    const Stencil y = stencil(p.y, interpolation);
    const Stencil z = stencil(p.z, interpolation);
    double value = 0.0;
    for (int k = 0; k < z.count; ++k) {
      double plane = 0.0;
      for (int j = 0; j < y.count; ++j) {
        const std::int16_t* samples = &samples_[index(x.first, y.first + j, z.first + k)];
        double row = 0.0;
        for (int i = 0; i < x.count; ++i) row += x.weight[static_cast<std::size_t>(i)] * samples[i];
        plane += y.weight[static_cast<std::size_t>(j)] * row;
      }
      value += z.weight[static_cast<std::size_t>(k)] * plane;
    }
    return value;
  }

 private:
  std::optional<double> trilinear(const glm::dvec3& position, std::int16_t background) const {
    const glm::dvec3 p = position - glm::dvec3(4 * first_);
    const glm::ivec3 low(p);
    assert(glm::all(glm::greaterThanEqual(low, glm::ivec3(0))) &&
           glm::all(glm::lessThan(low, glm::ivec3(side - 1))));
    const glm::dvec3 t = p - glm::dvec3(low);
    const std::int16_t* cell = &samples_[index(low.x, low.y, low.z)];
    bool any_background = false;
    for (const int row : {0, side, side * side, side * side + side})
      any_background |= cell[row] == background || cell[row + 1] == background;
    if (any_background) return std::nullopt;
    const auto along_x = [&](int offset) { return cell[offset] * (1.0 - t.x) + cell[offset + 1] * t.x; };
    const double below = along_x(0) * (1.0 - t.y) + along_x(side) * t.y;
    const double above = along_x(side * side) * (1.0 - t.y) + along_x(side * side + side) * t.y;
    return below * (1.0 - t.z) + above * t.z;
  }

  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(x + side * (y + side * z));
  }

  glm::ivec3 first_{0};
  glm::ivec3 count_{0};
  std::array<const std::int16_t*, leaves * leaves * leaves> chosen_;
  std::array<std::int16_t, side * side * side> samples_;
};

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
    const Status status =
        window_status(value_range(range, Interpolation::Nearest), window_.low, window_.high);
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

SampledWindowOperand::SampledWindowOperand(const Window& window, const glm::dmat4& still_from_target,
                                           Interpolation interpolation)
    : grey_(window.grey), low_(window.low), high_(window.high), interpolation_(interpolation) {
  const auto source_from_target = [&] {
    return glm::inverse(grey_.universe().lps_from_voxel) * still_from_target;
  };
  source_from_target_ = source_from_target();
  source_offset_ = whole_voxel_offset(source_from_target_);
  if (source_offset_) return;
  grey_ = window.grey.on_scan_lattice();
  source_from_target_ = source_from_target();
}

Meets SampledWindowOperand::meets(const Cube& cube) const {
  const MinMax range = range_within(grey_, support(source_from_target_, cube, interpolation_));
  return Meets::of(window_status(value_range(range, interpolation_), low_, high_));
}

bool SampledWindowOperand::contains(const glm::dvec3& p_voxel) const {
  const double value =
      value_at(grey_, glm::dvec3(source_from_target_ * glm::dvec4(p_voxel, 1.0)), interpolation_);
  return value >= low_ && value <= high_;
}

void SampledWindowOperand::words(const WantedLeaves& leaves) const {
  if (!source_offset_) return interpolated_words(leaves);
  const std::optional<Window16> window = window16(low_, high_);
  if (!window) return for_each_wanted(leaves, [](const glm::ivec3&) { return std::uint64_t{0}; });
  const ShiftedLeaves from(leaves.origin + *source_offset_);
  LeafWords region;
  region.read(grey_, *window, from.first, from.last);
  region.shifted(from.shift, leaves.words);
}

void SampledWindowOperand::interpolated_words(const WantedLeaves& leaves) const {
  NearSamples near;
  for_each_wanted(leaves, [&](const glm::ivec3& origin) -> std::uint64_t {
    const VoxelBox box = support(source_from_target_, {glm::dvec3(origin) + 1.5, 1.5}, interpolation_);
    const glm::ivec3 first = box.low >> 2;
    const glm::ivec3 last = box.high >> 2;
    const bool is_near = glm::all(glm::lessThan(last - first, glm::ivec3(NearSamples::leaves)));
    const MinMax samples = is_near ? near.choose(grey_, first, last) : range_within(grey_, box);
    const Status status = window_status(value_range(samples, interpolation_), low_, high_);
    if (status == Status::Empty) return 0;
    if (status == Status::Full) return all_children;
    if (is_near) near.fetch(grey_.background());
    std::uint64_t word = 0;
    for (int voxel = 0; voxel < 64; ++voxel) {
      const glm::dvec3 p(source_from_target_ * glm::dvec4(glm::dvec3(origin + child_place(voxel)), 1.0));
      // If a leaf's image spans too many source leaves, or a sample equals the background, the value is read
      // from the octree.
      const std::optional<double> quick =
          is_near ? near.interpolate(p, interpolation_, grey_.background()) : std::nullopt;
      const double value = quick ? *quick : value_at(grey_, p, interpolation_);
      word |= std::uint64_t{value >= low_ && value <= high_} << voxel;
    }
    return word;
  });
}

}  // namespace octotomy::voxel
