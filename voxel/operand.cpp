// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/operand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace octotomy::voxel {
namespace {

enum class Status { Empty, Full, Mixed };

glm::ivec3 child_place(int child) {
  return {child & 3, (child >> 2) & 3, child >> 4};
}

// Cover of a block from the status of each child, asked by the child's centre (of its voxels' centres).
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

template <typename Inside>
std::uint64_t leaf_of_voxels(const glm::ivec3& origin, const Inside& inside) {
  std::uint64_t word = 0;
  for (int voxel = 0; voxel < 64; ++voxel)
    word |= std::uint64_t{inside(glm::dvec3(origin + child_place(voxel)))} << voxel;
  return word;
}

// How far f may be wrong over a universe: a dot product of four terms of at most 2^12 times the gradient. The
// walk must leave to the leaf what rounding could decide either way, or the answer would depend on the tree's
// shape.
double rounding_slack(const Linear& f) {
  const double largest = (1 << Universe::max_depth) *
                             (std::abs(f.gradient.x) + std::abs(f.gradient.y) + std::abs(f.gradient.z)) +
                         std::abs(f.constant);
  return 8.0 * std::numeric_limits<double>::epsilon() * largest;
}

// How far f strays from its centre value within a child.
double reach(const Linear& f, int child_side) {
  return 0.5 * (child_side - 1) * (std::abs(f.gradient.x) + std::abs(f.gradient.y) + std::abs(f.gradient.z)) +
         rounding_slack(f);
}

Linear component(const glm::dmat4& map, int row) {
  return {{map[0][row], map[1][row], map[2][row]}, map[3][row]};
}

Linear along(const glm::dmat4& map, const glm::dvec3& direction, double offset) {
  Linear f;
  for (int row = 0; row < 3; ++row) {
    const Linear part = component(map, row);
    f.gradient += direction[row] * part.gradient;
    f.constant += direction[row] * part.constant;
  }
  f.constant -= offset;
  return f;
}

// The box in another frame that holds the centres of a child's voxels.
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

glm::ivec3 nearest_voxel(const glm::dvec3& p) {
  return glm::ivec3(glm::floor(p + 0.5));
}

// Voxel boxes, both ends included.
struct VoxelBox {
  glm::ivec3 low, high;
};

// Children of a block that voxels low..high of it touch, from 4^height voxels a side.
std::uint64_t children_within(const VoxelBox& box, int child_log2) {
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

Status joined(std::uint64_t within, std::uint64_t full, std::uint64_t some) {
  if ((full & within) == within) return Status::Full;
  return (some & within) == 0 ? Status::Empty : Status::Mixed;
}

// Status of a box of voxels, relative to the block that holds it.
Status status_within(BlockRef block, int height, const VoxelBox& box) {
  const Node* node = block.node();
  if (node == nullptr) return block.is_full() ? Status::Full : Status::Empty;
  const int child_log2 = 2 * height - 2;
  const std::uint64_t within = children_within(box, child_log2);
  const std::uint64_t partial = within & node->partial;
  const bool some_full = (within & node->full) != 0;
  const bool some_empty = (within & ~node->full & ~node->partial) != 0;
  if (some_full && some_empty) return Status::Mixed;
  if (partial == 0) return some_full ? Status::Full : Status::Empty;
  std::optional<Status> agreed;
  if (some_full) agreed = Status::Full;
  if (some_empty) agreed = Status::Empty;
  for (std::uint64_t rest = partial; rest != 0; rest &= rest - 1) {
    const int child = std::countr_zero(rest);
    const glm::ivec3 first = child_place(child) << child_log2;
    const VoxelBox part{glm::max(box.low - first, 0), glm::min(box.high - first, (1 << child_log2) - 1)};
    const Status status = height > 2 ? status_within(block.child(child), height - 1, part)
                                     : joined(children_within(part, 0), block.word(child), block.word(child));
    if (status == Status::Mixed || (agreed && *agreed != status)) return Status::Mixed;
    agreed = status;
  }
  return *agreed;
}

Status status_in_universe(const Octree& octree, VoxelBox box) {
  const int last = octree.universe().side() - 1;
  const VoxelBox clipped{glm::max(box.low, 0), glm::min(box.high, last)};
  if (glm::any(glm::greaterThan(clipped.low, clipped.high))) return Status::Empty;
  const Status status = status_within(octree.root(), octree.root_height(), clipped);
  const bool reaches_out = clipped.low != box.low || clipped.high != box.high;
  return reaches_out && status == Status::Full ? Status::Mixed : status;
}

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

// Whether a segment meets a rectangle, by separating axes: the rectangle's two and the segment's normal.
bool meets(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& centre, const glm::dvec2& half) {
  const glm::dvec2 middle = 0.5 * (a + b) - centre;
  const glm::dvec2 arm = 0.5 * (b - a);
  if (std::abs(middle.x) > half.x + std::abs(arm.x) || std::abs(middle.y) > half.y + std::abs(arm.y))
    return false;
  const double across = std::abs(middle.x * arm.y - middle.y * arm.x);
  return across <= half.x * std::abs(arm.y) + half.y * std::abs(arm.x);
}

Status status_in_region(const Region& region, const glm::dvec2& centre, const glm::dvec2& half) {
  for (const std::vector<glm::dvec2>& polygon : region.polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++)
      if (meets(polygon[last], polygon[i], centre, half)) return Status::Mixed;
  return contains(region, centre) ? Status::Full : Status::Empty;
}

}  // namespace

Cover ConvexOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Linear& side : sides_) {
    const double stray = reach(side, block.child_side);
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              const double value = side(centre);
              if (value + stray <= 0.0) return Status::Full;
              return value - stray > 0.0 ? Status::Empty : Status::Mixed;
            });
  }
  return cover;
}

std::uint64_t ConvexOperand::leaf(const glm::ivec3& origin) const {
  return leaf_of_voxels(origin, [&](const glm::dvec3& voxel) {
    return std::all_of(sides_.begin(), sides_.end(), [&](const Linear& side) { return side(voxel) <= 0.0; });
  });
}

Cover SphereOperand::cover(const TargetBlock& block) const {
  const Imager image(still_from_target_, block.child_side);
  const double square = sphere_.radius_mm * sphere_.radius_mm;
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const ImageBox box = image(centre);
    const glm::dvec3 nearest = glm::clamp(sphere_.centre_mm, box.low, box.high) - sphere_.centre_mm;
    const glm::dvec3 farthest =
        glm::max(glm::abs(box.low - sphere_.centre_mm), glm::abs(box.high - sphere_.centre_mm));
    if (glm::dot(nearest, nearest) > square) return Status::Empty;
    return glm::dot(farthest, farthest) <= square ? Status::Full : Status::Mixed;
  });
}

std::uint64_t SphereOperand::leaf(const glm::ivec3& origin) const {
  const double square = sphere_.radius_mm * sphere_.radius_mm;
  return leaf_of_voxels(origin, [&](const glm::dvec3& voxel) {
    const glm::dvec3 from_centre =
        glm::dvec3(still_from_target_ * glm::dvec4(voxel, 1.0)) - sphere_.centre_mm;
    return glm::dot(from_centre, from_centre) <= square;
  });
}

MaskOperand::MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target) {
  for (const Region& region : mask.regions)
    regions_.push_back({&region, along(still_from_target, region.view.right, 0.0),
                        along(still_from_target, region.view.up, 0.0)});
}

Cover MaskOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Projected& projected : regions_) {
    const glm::dvec2 half(reach(projected.u, block.child_side), reach(projected.v, block.child_side));
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              return status_in_region(*projected.region, {projected.u(centre), projected.v(centre)}, half);
            });
    if (cover.some == 0) break;
  }
  return cover;
}

std::uint64_t MaskOperand::leaf(const glm::ivec3& origin) const {
  return leaf_of_voxels(origin, [&](const glm::dvec3& voxel) {
    return std::all_of(regions_.begin(), regions_.end(), [&](const Projected& projected) {
      return contains(*projected.region, {projected.u(voxel), projected.v(voxel)});
    });
  });
}

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

std::uint64_t WindowOperand::leaf(const glm::ivec3& origin) const {
  const glm::ivec3 leaf = (origin >> 2) & 3;
  return window_bits64(
      grey_->brick(origin >> 4).samples[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))].data(),
      window_);
}

Cover SampledOctreeOperand::cover(const TargetBlock& block) const {
  const Imager image(source_from_target_, block.child_side);
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const ImageBox box = image(centre);
    return status_in_universe(*octree_, {nearest_voxel(box.low), nearest_voxel(box.high)});
  });
}

std::uint64_t SampledOctreeOperand::leaf(const glm::ivec3& origin) const {
  return leaf_of_voxels(origin, [&](const glm::dvec3& voxel) {
    return octree_->contains(nearest_voxel(glm::dvec3(source_from_target_ * glm::dvec4(voxel, 1.0))));
  });
}

Cover SampledWindowOperand::cover(const TargetBlock& block) const {
  const Imager image(source_from_target_, block.child_side);
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const ImageBox box = image(centre);
    const VoxelBox voxels{glm::ivec3(glm::floor(box.low)), glm::ivec3(glm::floor(box.high)) + 1};
    return status_of_range(range_within(window_->grey, voxels), window_->low, window_->high);
  });
}

std::uint64_t SampledWindowOperand::leaf(const glm::ivec3& origin) const {
  return leaf_of_voxels(origin, [&](const glm::dvec3& voxel) {
    const double value = interpolate(window_->grey, glm::dvec3(source_from_target_ * glm::dvec4(voxel, 1.0)));
    return value >= window_->low && value <= window_->high;
  });
}

Operand operand_of(const Program::Operand& operand, const Universe& target) {
  const glm::dmat4 still_from_target = glm::inverse(operand.moved_from_still) * target.lps_from_voxel;
  const auto source_from_target = [&](const Universe& source) {
    return glm::inverse(source.lps_from_voxel) * still_from_target;
  };
  struct Visitor {
    const Program::Operand& operand;
    const Universe& target;
    const glm::dmat4& still_from_target;
    const decltype(source_from_target)& source;

    Operand operator()(const Octree& octree) const {
      if (operand.still && octree.universe() == target) return AlignedOctreeOperand{octree.root()};
      return SampledOctreeOperand(octree, source(octree.universe()));
    }
    Operand operator()(const Window& window) const {
      if (operand.still && window.grey.universe() == target)
        if (const std::optional<Window16> bits = window16(window.low, window.high))
          return WindowOperand(window.grey, *bits);
      return SampledWindowOperand(window, source(window.grey.universe()));
    }
    Operand operator()(const RegionMask& mask) const { return MaskOperand(mask, still_from_target); }
    Operand operator()(const HalfSpace& half_space) const {
      return ConvexOperand({along(still_from_target, half_space.normal, half_space.offset_mm)});
    }
    Operand operator()(const Sphere& sphere) const { return SphereOperand(sphere, still_from_target); }
    Operand operator()(const Box& box) const {
      std::vector<Linear> sides;
      for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 outward(0.0);
        outward[axis] = 1.0;
        sides.push_back(along(still_from_target, outward, box.high_mm[axis]));
        sides.push_back(along(still_from_target, -outward, -box.low_mm[axis]));
      }
      return ConvexOperand(std::move(sides));
    }
  };
  return std::visit(Visitor{operand, target, still_from_target, source_from_target}, *operand.leaf);
}

}  // namespace octotomy::voxel
