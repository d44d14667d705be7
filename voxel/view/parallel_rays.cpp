// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/parallel_rays.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>
#include <utility>

// All computations use the mirrored frame, in which rays rise along all axes. There, ascending numbers of
// children and voxels run front to back for every ray.
//
// The table holds, for each cell of positions relative to the leaf's projection, the voxels of a leaf that
// rays in the cell may pass. The projection of a voxel and the cell are convex; they overlap unless the
// normal of an edge separates them. Whether a ray really passes a voxel of the table is then computed as in
// Walk.

namespace octotomy::voxel {
namespace {

/// An upper bound of the rounding error of a block's projection, as a share of the universe's extent in
/// pixels. Errors add up along the path from the root.
constexpr double rounding_share = 8.0 * std::numeric_limits<float>::epsilon();

/// A mask of the bits from first to last, both included.
std::uint64_t bits_between(int first, int last) {
  return (all_children << first) & (all_children >> (63 - last));
}

/// A mask of children in the mirrored frame.
std::uint64_t mirrored(std::uint64_t mask, const glm::ivec3& flipped) {
  const auto exchange = [&](std::uint64_t movers, int distance) {
    mask = ((mask >> distance) & movers) | ((mask & movers) << distance);
  };
  if (flipped.x != 0) {
    exchange(0x5555555555555555ULL, 1);
    exchange(0x3333333333333333ULL, 2);
  }
  if (flipped.y != 0) {
    exchange(0x0F0F0F0F0F0F0F0FULL, 4);
    exchange(0x00FF00FF00FF00FFULL, 8);
  }
  if (flipped.z != 0) {
    exchange(0x0000FFFF0000FFFFULL, 16);
    exchange(0x00000000FFFFFFFFULL, 32);
  }
  return mask;
}

}  // namespace

/// A square of pixels, and which of its rays are still open.
class ParallelRays::Square {
 public:
  Square(const ParallelRays& rays, const glm::ivec2& first_px, const glm::ivec2& last_px,
         const Accept& accept, const Announce& announce)
      : rays_(rays), first_px_(first_px), last_(last_px - first_px), accept_(accept), announce_(announce) {
    assert(last_.x >= 0 && last_.y >= 0 && last_.x < square_px && last_.y < square_px);
    for (int y = 0; y <= last_.y; ++y) open_[static_cast<std::size_t>(y)] = bits_between(0, last_.x);
  }

  void run() {
    const int height = rays_.octree_.root_height();
    const glm::dvec2 centre = glm::dmat3x2(rays_.px_from_mirrored_) *
                              (glm::dvec3(0.5 * rays_.mirror_.side) -
                               rays_.mirror_.mirrored(rays_.rays_.start(glm::dvec2(first_px_))));
    descend(rays_.octree_.root(), height, glm::ivec3(0), glm::vec2(centre));
  }

 private:
  /// Represents every position to the right of or below all pixels.
  static constexpr auto outside = static_cast<float>(2 * square_px);

  /// The range of pixels whose centres lie in a block's rectangle.
  struct Rectangle {
    int left, top, right, bottom;
    bool empty() const { return left > right || top > bottom; }
  };
  Rectangle about(const glm::vec2& centre, float edge) const {
    const glm::vec2 half = rays_.half_px_ * edge + rays_.rounding_px_;
    const auto from = [](float first) {
      return std::max(0, static_cast<int>(std::ceil(std::clamp(first - 0.5f, -1.0f, outside))));
    };
    const auto until = [](float last, int limit) {
      return std::min(limit, static_cast<int>(std::floor(std::clamp(last - 0.5f, -1.0f, outside))));
    };
    return {from(centre.x - half.x), from(centre.y - half.y), until(centre.x + half.x, last_.x),
            until(centre.y + half.y, last_.y)};
  }
  bool any_open(const Rectangle& pixels) const {
    const std::uint64_t columns = bits_between(pixels.left, pixels.right);
    for (int y = pixels.top; y <= pixels.bottom; ++y)
      if ((open_[static_cast<std::size_t>(y)] & columns) != 0) return true;
    return false;
  }

  void descend(BlockRef block, int height, const glm::ivec3& corner, const glm::vec2& centre) {
    if (block.is_empty()) return;
    const Rectangle pixels = about(centre, static_cast<float>(1 << (2 * height)));
    if (pixels.empty() || !any_open(pixels)) return;
    const Node* node = block.node();
    const std::uint64_t present =
        node == nullptr ? all_children : mirrored(node->full | node->partial, rays_.mirror_.flipped);
    if (height == 2) {
      cast_leaves(block, present, corner, centre);
      return;
    }
    const int edge = 1 << (2 * height - 2);
    for (std::uint64_t rest = present; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      descend(block.child(child ^ rays_.mirror_.flipped_child), height - 1,
              corner + child_place(child) * edge,
              centre + rays_.places_[static_cast<std::size_t>(child)] * static_cast<float>(edge));
    }
  }

  /// A leaf that open rays may meet.
  struct Leaf {
    int child = 0;  ///< of its block
    glm::vec2 centre{0.0f};
    Rectangle pixels{0, 0, 0, 0};
  };

  /// Announces each leaf of a block of height 2, and casts it a few leaves later, when its data has been
  /// prefetched.
  void cast_leaves(BlockRef block, std::uint64_t present, const glm::ivec3& corner, const glm::vec2& centre) {
    constexpr std::size_t ahead = 4;
    std::array<Leaf, 64> leaves;
    std::size_t count = 0, offered = 0;
    const auto offer_next = [&] {
      const Leaf& leaf = leaves[offered++];
      cast_leaf(mirrored(block.word(leaf.child ^ rays_.mirror_.flipped_child), rays_.mirror_.flipped),
                corner + child_place(leaf.child) * 4, leaf);
    };
    for (std::uint64_t rest = present; rest != 0; rest &= rest - 1) {
      Leaf leaf{std::countr_zero(rest)};
      leaf.centre = centre + rays_.places_[static_cast<std::size_t>(leaf.child)] * 4.0f;
      leaf.pixels = about(leaf.centre, 4.0f);
      if (leaf.pixels.empty() || !any_open(leaf.pixels)) continue;
      leaves[count++] = leaf;
      if (announce_)
        announce_(rays_.mirror_.native(corner + child_place(leaf.child) * 4 + 3 * rays_.mirror_.flipped));
      if (count - offered > ahead) offer_next();
    }
    while (offered < count) offer_next();
  }

  /// Passes a leaf's voxels to the open rays that meet them.
  void cast_leaf(std::uint64_t word, const glm::ivec3& corner, const Leaf& leaf) {
    const Rectangle& pixels = leaf.pixels;
    const glm::vec2& centre = leaf.centre;
    const glm::vec2 half = 4.0f * rays_.half_px_;
    const glm::vec2 per_px = static_cast<float>(cells) / (2.0f * half);
    const glm::vec2 first = (0.5f - centre + half) * per_px;
    const auto cell = [](float position) { return std::clamp(static_cast<int>(position), 0, cells - 1); };
    std::array<std::int8_t, square_px> cell_of_column;
    for (int x = pixels.left; x <= pixels.right; ++x)
      cell_of_column[static_cast<std::size_t>(x)] =
          static_cast<std::int8_t>(cell(first.x + static_cast<float>(x) * per_px.x));
    const std::uint64_t columns = bits_between(pixels.left, pixels.right);
    batch_.leaf = corner;
    for (int y = pixels.top; y <= pixels.bottom; ++y) {
      const std::uint64_t open = open_[static_cast<std::size_t>(y)] & columns;
      if (open == 0) continue;
      const std::uint64_t* row =
          rays_.passed_.data() + cell(first.y + static_cast<float>(y) * per_px.y) * cells;
      for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
        const int x = std::countr_zero(rest);
        const std::uint64_t voxels = row[cell_of_column[static_cast<std::size_t>(x)]] & word;
        if (voxels == 0) continue;
        add({x, y}, voxels);
        if (batch_.count == RayBatch::most) offer();
      }
    }
    offer();
  }

  /// Adds a ray that may pass some voxels of the leaf.
  void add(const glm::ivec2& pixel, std::uint64_t voxels) {
    const auto ray = static_cast<std::size_t>(batch_.count++);
    batch_.x[ray] = first_px_.x + pixel.x;
    batch_.y[ray] = first_px_.y + pixel.y;
    voxels_[ray] = voxels;
  }

  /// Passes the voxels of the batch's rays to `accept_`, front to back, until each ray has ended or left the
  /// leaf.
  void offer() {
    for (drop_missed(); batch_.count > 0; drop_missed()) move_on(0, accept_(batch_));
  }

  /// Moves each ray to the first voxel that it passes, and removes rays that pass no voxel, so that vectors
  /// of rays stay full.
  void drop_missed() {
    for (int done = 0; done < batch_.count;) {
      const RayBatch::Rays passing = find_passages(rays_.rays_, rays_.mirror_, voxels_, done, batch_);
      done = bring_forward(passing, done);
      move_on(done, 0);
    }
  }

  /// Reorders the rays from number `first` on so that the passing rays come first. Returns the number of the
  /// first ray that does not pass.
  int bring_forward(RayBatch::Rays passing, int first) {
    const int end = first + std::popcount(passing);
    if (end == batch_.count) return end;
    const RayBatch::Rays behind = RayBatch::from(end);
    RayBatch::Rays free = ~passing & ~behind & RayBatch::from(first);
    for (RayBatch::Rays rest = passing & behind; rest != 0; rest &= rest - 1, free &= free - 1) {
      const auto ray = static_cast<std::size_t>(std::countr_zero(rest));
      const auto place = static_cast<std::size_t>(std::countr_zero(free));
      const std::int32_t x = batch_.x[place], y = batch_.y[place];
      batch_.put(ray, place);
      batch_.x[ray] = x;
      batch_.y[ray] = y;
      std::swap(voxels_[ray], voxels_[place]);
    }
    return end;
  }

  /// Moves rays from number `first` on to the next voxel that each may pass, and removes those that have none
  /// or have ended.
  void move_on(int first, RayBatch::Rays ended) {
    const int count = std::exchange(batch_.count, first);
    for (int i = first; i < count; ++i) {
      const auto ray = static_cast<std::size_t>(i);
      const glm::ivec2 pixel = glm::ivec2(batch_.x[ray], batch_.y[ray]) - first_px_;
      if (((ended >> i) & 1) != 0) {
        open_[static_cast<std::size_t>(pixel.y)] &= ~(std::uint64_t{1} << pixel.x);
        continue;
      }
      const std::uint64_t voxels = voxels_[ray] & (voxels_[ray] - 1);
      if (voxels != 0) add(pixel, voxels);
    }
  }

  const ParallelRays& rays_;
  glm::ivec2 first_px_;
  glm::ivec2 last_;  ///< last pixel of the square
  const Accept& accept_;
  const Announce& announce_;
  std::array<std::uint64_t, square_px> open_{};  ///< by row
  RayBatch batch_;
  RayBatch::ByRay<std::uint64_t> voxels_{};  ///< voxels that each ray of the batch may pass, one bit each
};

ParallelRays::ParallelRays(const Octree& octree, const VoxelRays& rays)
    : octree_(octree), rays_(rays), mirror_(rays.per_mm, 1 << (2 * octree.root_height())) {
  const glm::dmat3 px_mm_from_voxel = glm::inverse(glm::dmat3(rays.per_px_x, rays.per_px_y, rays.per_mm));
  glm::vec2 extent(0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    px_from_mirrored_[axis] = glm::dvec2(px_mm_from_voxel[axis]) * (mirror_.flipped[axis] != 0 ? -1.0 : 1.0);
    extent += glm::abs(glm::vec2(px_from_mirrored_[axis]));
  }
  half_px_ = 0.5f * extent;
  rounding_px_ = static_cast<float>(rounding_share * mirror_.side) * std::max(extent.x, extent.y);
  for (int child = 0; child < 64; ++child)
    places_[static_cast<std::size_t>(child)] = px_from_mirrored_ * (glm::dvec3(child_place(child)) - 1.5);
  tabulate();
}

void ParallelRays::tabulate() {
  const glm::dvec2 half_leaf(4.0f * half_px_);
  const glm::dvec2 half_cell = half_leaf / double{cells} + 2.0 * double{rounding_px_};
  const auto apart = [&](const glm::dvec2& normal, const glm::dvec2& between) {
    double reach = glm::dot(glm::abs(normal), half_cell);
    for (int axis = 0; axis < 3; ++axis) reach += 0.5 * std::abs(glm::dot(normal, px_from_mirrored_[axis]));
    return std::abs(glm::dot(normal, between)) > reach;
  };
  passed_.assign(static_cast<std::size_t>(cells) * cells, 0);
  tbb::parallel_for(0, int{cells}, [&](int y) {
    for (int x = 0; x < cells; ++x) {
      const glm::dvec2 cell = half_leaf * ((glm::dvec2(x, y) + 0.5) * 2.0 / double{cells} - 1.0);
      std::uint64_t voxels = 0;
      for (int child = 0; child < 64; ++child) {
        const glm::dvec2 between = px_from_mirrored_ * (glm::dvec3(child_place(child)) - 1.5) - cell;
        bool meets = !apart({1, 0}, between) && !apart({0, 1}, between);
        for (int axis = 0; axis < 3; ++axis) {
          const glm::dvec2 edge = px_from_mirrored_[axis];
          meets = meets && !apart({-edge.y, edge.x}, between);
        }
        if (meets) voxels |= std::uint64_t{1} << child;
      }
      passed_[static_cast<std::size_t>(y) * cells + static_cast<std::size_t>(x)] = voxels;
    }
  });
}

ParallelRays ParallelRays::through(const Octree& octree) const {
  ParallelRays others = *this;
  others.octree_ = octree;
  return others;
}

void ParallelRays::cast(const glm::ivec2& first_px, const glm::ivec2& last_px, const Accept& accept,
                        const Announce& announce) const {
  assert(glm::all(glm::lessThanEqual(first_px, last_px)) &&
         glm::all(glm::lessThan(last_px - first_px, glm::ivec2(square_px))));
  Square(*this, first_px, last_px, accept, announce).run();
}

}  // namespace octotomy::voxel
