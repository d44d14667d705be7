// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/ray_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/octree_node.h"

// A ray walks the octree block by block: it descends to the block it is in and, where that is empty, leaves
// it through the plane it reaches first (Amanatides, Woo 1987, on blocks of any size). Only what differs in
// the voxel's position is descended again.
//
// 1 Tiles of pixels get far bounds from the objects' blocks of 16 voxels a side, projected, and near bounds
//   from the leaves of those that are not surely behind others.
// 2 A ray walks between the bounds of its tile; rays of tiles that hold nothing are not cast.
// 3 At a voxel of an object the surface is sought by samples along the ray, or the voxel's face is taken.
//
// Rays are walked in the *mirrored frame*: index space shifted so that voxel i reaches from i to i + 1, with
// the axes along which the ray falls reversed, so that it rises along all. A ray that does not move along an
// axis never leaves a block through it: its time to every plane there is infinite.

namespace octotomy::voxel {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Pixels along a tile's edge: about those that a leaf takes at the usual pixel a voxel.
constexpr int tile_px = 4;
constexpr int max_height = Universe::max_depth / 2;

struct DepthBounds {
  float near_mm = std::numeric_limits<float>::infinity();
  float far_mm = -std::numeric_limits<float>::infinity();
};

/// What all rays of a view have in common in the mirrored frame.
struct Mirror {
  Mirror(const VoxelRays& rays, int root_side) : side(root_side) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = rays.per_mm[axis];
      flipped[axis] = speed < 0.0 ? 1 : 0;
      speed_per_mm[axis] = std::abs(speed);
      still[axis] = speed == 0.0;
      mm_per_voxel[axis] = still[axis] ? 0.0 : 1.0 / std::abs(speed);
      exit_offset[axis] = still[axis] ? infinity : 0.0;
    }
    flipped_child = child_index(3 * flipped.x, 3 * flipped.y, 3 * flipped.z);
  }
  glm::dvec3 mirrored(const glm::dvec3& p_voxel) const {
    const glm::dvec3 p = p_voxel + 0.5;
    return glm::mix(p, double(side) - p, glm::dvec3(flipped));
  }
  glm::ivec3 native(const glm::ivec3& voxel) const { return voxel + flipped * (side - 1 - 2 * voxel); }

  int side = 0;
  glm::ivec3 flipped{0};
  int flipped_child = 0;
  glm::bvec3 still{false};
  glm::dvec3 speed_per_mm{0.0};
  glm::dvec3 mm_per_voxel{0.0};
  glm::dvec3 exit_offset{0.0};
};

/// Bounds of the depths at which rays of each tile can meet an object.
class TileBounds {
 public:
  TileBounds(const ImagePlane& plane, const VoxelRays& rays, const Mirror& mirror)
      : tiles_((plane.size_px + (tile_px - 1)) / tile_px),
        bounds_(static_cast<std::size_t>(tiles_.x) * static_cast<std::size_t>(tiles_.y)),
        range_mm_(static_cast<float>(plane.depth_range_mm)),
        front_first_(mirror.flipped_child),
        tile_from_voxel_(glm::inverse(
            glm::dmat3(rays.per_px_x * double{tile_px}, rays.per_px_y * double{tile_px}, rays.per_mm))),
        first_(rays.first) {
    for (int height = 1; height <= max_height; ++height)
      half_[static_cast<std::size_t>(height)] = half_of(1 << (2 * height));
    for (int child = 0; child < 64; ++child)
      leaf_offset_[static_cast<std::size_t>(child)] =
          tile_from_voxel_ * glm::dvec3(4.0 * glm::dvec3(child & 3, (child >> 2) & 3, child >> 4) - 6.0);
  }

  /// Bounds of the tile that holds a pixel position; those of the whole universe outside the picture.
  DepthBounds at(const glm::dvec2& p_px) const {
    const glm::ivec2 tile(p_px / double{tile_px});
    if (p_px.x < 0.0 || p_px.y < 0.0 || tile.x >= tiles_.x || tile.y >= tiles_.y) return {0.0f, range_mm_};
    return bounds_[index(tile.x, tile.y)];
  }

  /// Widens the bounds by a block, its children front to back so that little behind the front is looked into.
  void add(BlockRef block, int height, const glm::ivec3& corner) {
    if (block.is_empty()) return;
    const int edge = 1 << (2 * (height - 1));
    const Node* node = block.node();
    if (node == nullptr || height == 2) {
      const glm::vec3 centre = tile_from_voxel_ * (glm::dvec3(corner) + (2.0 * edge - 0.5) - first_);
      const glm::vec3 half = half_[static_cast<std::size_t>(height)];
      if (!widen_far(centre, half)) return;
      if (node == nullptr) {
        widen_near(centre, half);
      } else {
        add_leaves(node->full | node->partial, centre);
      }
      return;
    }
    for (int i = 0; i < 64; ++i) {
      const int child = i ^ front_first_;
      add(block.child(child), height - 1,
          corner + glm::ivec3(child & 3, (child >> 2) & 3, child >> 4) * edge);
    }
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles_.x) + static_cast<std::size_t>(x);
  }
  struct Tiles {
    glm::ivec2 first{0};
    glm::ivec2 last{-1};
  };

  /// Half a block's extent in tiles and millimetres of depth, a voxel more on every side because the surface
  /// of a grey object may lie up to a voxel before the object's first voxel.
  glm::vec3 half_of(int edge) const {
    return (0.5 * edge + 1.0) *
           (glm::abs(tile_from_voxel_[0]) + glm::abs(tile_from_voxel_[1]) + glm::abs(tile_from_voxel_[2]));
  }
  Tiles covered(const glm::vec3& centre, const glm::vec3& half) const {
    const auto floored = [](float value) {
      const int towards_zero = static_cast<int>(value);
      return towards_zero - (value < static_cast<float>(towards_zero) ? 1 : 0);
    };
    const auto within = [](float value) { return std::clamp(value, -1e6f, 1e6f); };
    return {
        {std::max(0, floored(within(centre.x - half.x))), std::max(0, floored(within(centre.y - half.y)))},
        {std::min(tiles_.x - 1, floored(within(centre.x + half.x))),
         std::min(tiles_.y - 1, floored(within(centre.y + half.y)))}};
  }

  /// False where the block cannot be the nearest in any tile.
  bool widen_far(const glm::vec3& centre, const glm::vec3& half) {
    const Tiles tiles = covered(centre, half);
    bool nearest = false;
    for (int y = tiles.first.y; y <= tiles.last.y; ++y)
      for (int x = tiles.first.x; x <= tiles.last.x; ++x) {
        DepthBounds& bounds = bounds_[index(x, y)];
        bounds.far_mm = std::max(bounds.far_mm, centre.z + half.z);
        nearest = nearest || centre.z - half.z < bounds.near_mm;
      }
    return nearest;
  }
  void widen_near(const glm::vec3& centre, const glm::vec3& half) {
    const Tiles tiles = covered(centre, half);
    for (int y = tiles.first.y; y <= tiles.last.y; ++y)
      for (int x = tiles.first.x; x <= tiles.last.x; ++x) {
        DepthBounds& bounds = bounds_[index(x, y)];
        bounds.near_mm = std::min(bounds.near_mm, centre.z - half.z);
      }
  }
  void add_leaves(std::uint64_t leaves, const glm::vec3& centre) {
    for (; leaves != 0; leaves &= leaves - 1)
      widen_near(centre + leaf_offset_[static_cast<std::size_t>(std::countr_zero(leaves))], half_[1]);
  }

  glm::ivec2 tiles_;
  std::vector<DepthBounds> bounds_;
  float range_mm_;
  int front_first_;             ///< exclusive-or that puts a node's children front to back
  glm::dmat3 tile_from_voxel_;  ///< to tiles along x, along y, and millimetres of depth
  glm::dvec3 first_;
  std::array<glm::vec3, max_height + 1> half_{};  ///< by the height of a block
  std::array<glm::vec3, 64> leaf_offset_{};       ///< from the centre of a block of height 2
};

/// A voxel of the object as a ray passes it.
struct Passage {
  glm::ivec3 voxel{0};  ///< mirrored
  double enter_mm = 0.0;
  double leave_mm = 0.0;
  int entered_through = 0;  ///< axis
};

/// Rays' ways through one octree. The path to the last voxel is kept: rays close to each other share most of
/// it.
class Walk {
 public:
  Walk(BlockRef root, int height, const Mirror& mirror) : mirror_(mirror), top_(height), lowest_(height) {
    nodes_[static_cast<std::size_t>(height)] = root.node();
    full_root_ = root.is_full();
  }

  /// Offers the object's voxels that a ray passes from one depth until another, in order, to `accept`,
  /// until it accepts one.
  template <typename Accept>
  void run(const glm::dvec3& start, double from_mm, double until_mm, const Accept& accept) {
    start_ = start;
    at_mm_ = from_mm;
    for (int axis = 0; axis < 3; ++axis) {
      if (mirror_.still[axis]) {
        if (!(start_[axis] >= 0.0 && start_[axis] < mirror_.side)) return;
        continue;
      }
      at_mm_ = std::max(at_mm_, -start_[axis] * mirror_.mm_per_voxel[axis]);
      until_mm = std::min(until_mm, (mirror_.side - start_[axis]) * mirror_.mm_per_voxel[axis]);
    }
    go_to(glm::ivec3(glm::clamp(glm::floor(start_ + at_mm_ * mirror_.speed_per_mm), glm::dvec3(0.0),
                                glm::dvec3(mirror_.side - 1))));
    while (at_mm_ <= until_mm) {
      const int edge = empty_edge();
      if (edge > 1) {
        if (!leave(edge)) return;
      } else if (lowest_ == 1) {
        const LeafWay way = pass_leaf(until_mm, accept);
        if (way == LeafWay::Accepted || (way == LeafWay::Left && !inside_root())) return;
      } else {
        // A Full block: voxel by voxel.
        if (accept(pass()) || !leave(1)) return;
      }
    }
  }

 private:
  enum class LeafWay { Accepted, Left, Behind };

  /// Walks the voxels of the leaf that holds the voxel; afterwards the voxel is the first behind the leaf.
  template <typename Accept>
  LeafWay pass_leaf(double until_mm, const Accept& accept) {
    const glm::ivec3 first = voxel_;
    glm::dvec3 time = (glm::dvec3(voxel_ + 1) - start_) * mirror_.mm_per_voxel + mirror_.exit_offset;
    while (at_mm_ <= until_mm) {
      const int bit =
          ((voxel_.x & 3) | ((voxel_.y & 3) << 2) | ((voxel_.z & 3) << 4)) ^ mirror_.flipped_child;
      if (((word_ >> bit) & 1) != 0 && accept(pass())) return LeafWay::Accepted;
      const double leave_mm = std::min(time.x, std::min(time.y, time.z));
      const glm::ivec3 step(time.x <= leave_mm, time.y <= leave_mm, time.z <= leave_mm);
      const glm::ivec3 next = voxel_ + step;
      const int changed = (next.x ^ voxel_.x) | (next.y ^ voxel_.y) | (next.z ^ voxel_.z);
      voxel_ = next;
      at_mm_ = std::max(at_mm_, leave_mm);
      if (changed > 3) {
        forget(first);
        return LeafWay::Left;
      }
      time = (glm::dvec3(voxel_ + 1) - start_) * mirror_.mm_per_voxel + mirror_.exit_offset;
    }
    return LeafWay::Behind;
  }

  bool inside_root() const { return ((voxel_.x | voxel_.y | voxel_.z) & mirror_.side) == 0; }

  /// Keeps of the path what the voxel shares with another one.
  void forget(const glm::ivec3& other) {
    const auto changed =
        static_cast<unsigned>((voxel_.x ^ other.x) | (voxel_.y ^ other.y) | (voxel_.z ^ other.z));
    lowest_ = std::min(top_, std::max(lowest_, static_cast<int>(std::bit_width(changed) + 1) / 2));
  }
  void go_to(const glm::ivec3& voxel) {
    const glm::ivec3 other = voxel_;
    voxel_ = voxel;
    forget(other);
  }

  /// Edge of the largest aligned empty block found about the voxel; 0 where the voxel is in a Full block, or
  /// in a leaf, whose word is then at hand.
  int empty_edge() {
    if (nodes_[static_cast<std::size_t>(top_)] == nullptr) return full_root_ ? 0 : mirror_.side;
    while (lowest_ > 1) {
      const int shift = 2 * (lowest_ - 1);
      const int child =
          (((voxel_.x >> shift) & 3) | (((voxel_.y >> shift) & 3) << 2) | (((voxel_.z >> shift) & 3) << 4)) ^
          mirror_.flipped_child;
      const std::uint64_t bit = std::uint64_t{1} << child;
      const Node& node = *nodes_[static_cast<std::size_t>(lowest_)];
      if ((node.partial & bit) == 0) {
        if ((node.full & bit) != 0) return 0;
        // The child is empty; so may be the logical octant it is in.
        const std::uint64_t present = node.full | node.partial;
        const bool octant_empty = (present & (octant_children << (child & 0b101010))) == 0;
        return (octant_empty ? 2 : 1) << shift;
      }
      const int rank = node.rank(child);
      --lowest_;
      if (lowest_ == 1) {
        word_ = node.words()[rank];
      } else {
        nodes_[static_cast<std::size_t>(lowest_)] = node.nodes()[rank];
      }
    }
    return 0;
  }

  Passage pass() const {
    Passage passage{voxel_, -infinity, infinity, 0};
    for (int axis = 0; axis < 3; ++axis) {
      if (mirror_.still[axis]) continue;
      const double enter = (voxel_[axis] - start_[axis]) * mirror_.mm_per_voxel[axis];
      if (enter > passage.enter_mm) {
        passage.enter_mm = enter;
        passage.entered_through = axis;
      }
      passage.leave_mm = std::min(passage.leave_mm, enter + mirror_.mm_per_voxel[axis]);
    }
    return passage;
  }

  /// Moves into the voxel behind the aligned block of the given edge; false where that leaves the root block.
  bool leave(int edge) {
    const glm::ivec3 end = (voxel_ & ~(edge - 1)) + edge;
    const glm::dvec3 time = (glm::dvec3(end) - start_) * mirror_.mm_per_voxel + mirror_.exit_offset;
    const double leave_mm = std::min(time.x, std::min(time.y, time.z));
    const glm::dvec3 p = start_ + leave_mm * mirror_.speed_per_mm;
    // Rounding must not carry the ray out of the block's other sides, nor back. Chosen without branches, for
    // which side a ray leaves through cannot be predicted.
    const auto next = [leave_mm](double time_mm, double position, int from, int behind) {
      const int inside = std::min(std::max(static_cast<int>(position), from), behind - 1);
      return time_mm <= leave_mm ? behind : inside;
    };
    const glm::ivec3 voxel(next(time.x, p.x, voxel_.x, end.x), next(time.y, p.y, voxel_.y, end.y),
                           next(time.z, p.z, voxel_.z, end.z));
    // The root block's edge is a power of two.
    if (((voxel.x | voxel.y | voxel.z) & mirror_.side) != 0) return false;
    go_to(voxel);
    at_mm_ = std::max(at_mm_, leave_mm);
    return true;
  }

  const Mirror& mirror_;
  glm::dvec3 start_{0.0};
  int top_;
  int lowest_;  ///< height of the lowest node known to hold the voxel; 1: word_
  bool full_root_ = false;
  glm::ivec3 voxel_{0};
  double at_mm_ = 0.0;
  std::uint64_t word_ = 0;
  std::array<const Node*, max_height + 1> nodes_{};
};

/// Trilinear samples along one ray; the eight corners of the last cell are kept.
class RaySamples {
 public:
  RaySamples(const GreyOctree& grey, const glm::dvec3& start, const glm::dvec3& per_mm)
      : grey_(grey), start_(start), per_mm_(per_mm), last_(grey.universe().side() - 2) {}

  double voxel(const glm::ivec3& voxel) const { return at(voxel); }

  double operator()(double depth_mm) {
    const glm::dvec3 p = glm::clamp(start_ + depth_mm * per_mm_, glm::dvec3(0.0), glm::dvec3(last_ + 1));
    const glm::ivec3 cell = glm::min(glm::ivec3(p), glm::ivec3(last_));
    if (cell != cell_) {
      cell_ = cell;
      fetch_corners();
    }
    const glm::dvec3 t = p - glm::dvec3(cell);
    const auto along_x = [&](std::size_t corner) {
      return corners_[corner] + (corners_[corner + 1] - corners_[corner]) * t.x;
    };
    const double below = along_x(0) + (along_x(2) - along_x(0)) * t.y;
    const double above = along_x(4) + (along_x(6) - along_x(4)) * t.y;
    return below + (above - below) * t.z;
  }

 private:
  void fetch_corners() {
    // Five cells in six lie within one brick, which is then found once.
    const bool one_brick = (cell_.x & 15) != 15 && (cell_.y & 15) != 15 && (cell_.z & 15) != 15;
    if (!one_brick) {
      for (int corner = 0; corner < 8; ++corner)
        corners_[static_cast<std::size_t>(corner)] =
            at(cell_ + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2));
      return;
    }
    const std::int16_t* samples = grey_.brick(cell_ >> 4).samples.front().data();
    const int x0 = along(cell_.x), x1 = along(cell_.x + 1);
    const int y0 = along(cell_.y) << 2, y1 = along(cell_.y + 1) << 2;
    const int z0 = along(cell_.z) << 4, z1 = along(cell_.z + 1) << 4;
    corners_ = {double(samples[x0 + y0 + z0]), double(samples[x1 + y0 + z0]), double(samples[x0 + y1 + z0]),
                double(samples[x1 + y1 + z0]), double(samples[x0 + y0 + z1]), double(samples[x1 + y0 + z1]),
                double(samples[x0 + y1 + z1]), double(samples[x1 + y1 + z1])};
  }
  /// A brick's samples are numbered by leaf, then by voxel, each x + 4y + 16z: the part of one coordinate,
  /// that of x.
  static int along(int coordinate) { return ((coordinate >> 2) & 3) * 64 + (coordinate & 3); }
  /// Precondition: within the universe.
  double at(const glm::ivec3& voxel) const {
    const std::int16_t* samples = grey_.brick(voxel >> 4).samples.front().data();
    return samples[along(voxel.x) + (along(voxel.y) << 2) + (along(voxel.z) << 4)];
  }

  const GreyOctree& grey_;
  glm::dvec3 start_, per_mm_;
  int last_;  ///< highest cell
  glm::ivec3 cell_{-1};
  std::array<double, 8> corners_{};
};

/// A sample and where on the ray it is.
struct Sample {
  double depth_mm = 0.0;
  double value = 0.0;
};

/// Where the samples cross the threshold between one below it and one not below: linear interpolation, once
/// repeated on the side that holds the crossing. A trilinear sample along a ray is a cubic, which within half
/// a voxel this leaves by less than the rounding of samples to whole numbers makes of it.
double crossing(RaySamples& samples, double threshold, Sample below, Sample above) {
  const auto between = [&] {
    return below.depth_mm +
           (above.depth_mm - below.depth_mm) * (threshold - below.value) / (above.value - below.value);
  };
  Sample middle{between(), 0.0};
  middle.value = samples(middle.depth_mm);
  (middle.value < threshold ? below : above) = middle;
  return above.value > below.value ? between() : middle.depth_mm;
}

/// The surface of a grey object at a voxel that its ray passes; none where the ray stays outside it.
std::optional<Seen> grey_surface(RaySamples& samples, double threshold, const Mirror& mirror,
                                 const Passage& passage, int universe_side) {
  const auto face = [&] { return Seen{static_cast<float>(passage.enter_mm), 0, true}; };
  const auto surface = [&](Sample below, Sample above) {
    return Seen{static_cast<float>(crossing(samples, threshold, below, above)), 0, false};
  };
  // A voxel below the threshold is not the object's by its sample: its face is all there is.
  if (samples.voxel(mirror.native(passage.voxel)) < threshold) return face();
  const Sample enter{passage.enter_mm, samples(passage.enter_mm)};
  if (enter.value < threshold) {
    const double middle_mm = 0.5 * (passage.enter_mm + passage.leave_mm);
    const Sample middle{middle_mm, samples(middle_mm)};
    if (middle.value >= threshold) return surface(enter, middle);
    const Sample leave{passage.leave_mm, samples(passage.leave_mm)};
    if (leave.value >= threshold) return surface(middle, leave);
    return std::nullopt;
  }
  // The surface lies before the voxel, unless the voxel before was cut away.
  glm::ivec3 before = passage.voxel;
  --before[passage.entered_through];
  before = mirror.native(before);
  if (glm::any(glm::lessThan(before, glm::ivec3(0))) ||
      glm::any(glm::greaterThanEqual(before, glm::ivec3(universe_side))) ||
      samples.voxel(before) >= threshold)
    return face();
  // Trilinear surfaces end within a voxel of the object's voxels, along a slanting ray within two.
  const double half_voxel_mm = 0.5 / glm::length(mirror.speed_per_mm);
  Sample above = enter;
  for (int step = 1; step <= 4; ++step) {
    const double depth_mm = passage.enter_mm - step * half_voxel_mm;
    const Sample sample{depth_mm, samples(depth_mm)};
    if (sample.value < threshold) return surface(sample, above);
    above = sample;
  }
  return face();
}

}  // namespace

struct RayCast::Prepared {
  std::vector<Drawn> objects;
  VoxelRays rays;
  Mirror mirror;
  TileBounds bounds;
  glm::ivec2 size_px{0};
  double voxel_mm = 1.0;  ///< depth of a ray's way of a voxel's edge
};

RayCast::RayCast(const std::vector<Drawn>& objects, const ImagePlane& plane) {
  const Octree& first = objects.front().octree;
  const VoxelRays rays = voxel_rays(first.universe(), plane);
  const Mirror mirror(rays, 1 << (2 * first.root_height()));
  auto prepared = std::make_shared<Prepared>(Prepared{objects, rays, mirror, TileBounds(plane, rays, mirror),
                                                      plane.size_px, 1.0 / glm::length(mirror.speed_per_mm)});
  for (const Drawn& object : objects)
    prepared->bounds.add(object.octree.root(), object.octree.root_height(), glm::ivec3(0));
  prepared_ = std::move(prepared);
}

namespace {

/// Casts rays close to each other, one after the other.
class Caster {
 public:
  explicit Caster(const RayCast::Prepared& prepared) : prepared_(prepared) {
    walks_.reserve(prepared.objects.size());
    for (const Drawn& object : prepared.objects)
      walks_.emplace_back(object.octree.root(), object.octree.root_height(), prepared.mirror);
  }

  Seen seen(const glm::dvec2& p_px, double near_mm, double far_mm) {
    DepthBounds bounds = prepared_.bounds.at(p_px);
    bounds.near_mm = std::max(bounds.near_mm, static_cast<float>(near_mm));
    bounds.far_mm = std::min(bounds.far_mm, static_cast<float>(far_mm));
    Seen nearest;
    if (bounds.near_mm > bounds.far_mm) return nearest;
    const glm::dvec3 start = prepared_.rays.start(p_px);
    const glm::dvec3 mirrored = prepared_.mirror.mirrored(start);
    double until_mm = bounds.far_mm;
    for (std::size_t i = 0; i < prepared_.objects.size(); ++i) {
      const Drawn& object = prepared_.objects[i];
      const int universe_side = object.octree.universe().side();
      // A voxel behind what was found may still have its grey surface before it.
      const double reach_mm = object.grey ? 2.0 * prepared_.voxel_mm : 0.0;
      const auto found = [&](Seen seen) {
        seen.object = static_cast<std::int16_t>(i);
        if (seen.depth_mm < nearest.depth_mm) nearest = seen;
        until_mm = std::min(until_mm, static_cast<double>(nearest.depth_mm));
        return true;
      };
      if (object.grey) {
        RaySamples samples(*object.grey, start, prepared_.rays.per_mm);
        walks_[i].run(mirrored, bounds.near_mm, until_mm + reach_mm, [&](const Passage& passage) {
          const std::optional<Seen> seen =
              grey_surface(samples, object.threshold, prepared_.mirror, passage, universe_side);
          return seen ? found(*seen) : false;
        });
      } else {
        walks_[i].run(mirrored, bounds.near_mm, until_mm + reach_mm, [&](const Passage& passage) {
          return found({static_cast<float>(passage.enter_mm), 0, true});
        });
      }
    }
    return nearest;
  }

 private:
  const RayCast::Prepared& prepared_;
  std::vector<Walk> walks_;
};

}  // namespace

Seen RayCast::seen(const glm::dvec2& p_px) const {
  return seen(p_px, -infinity, infinity);
}

Seen RayCast::seen(const glm::dvec2& p_px, double near_mm, double far_mm) const {
  return Caster(*prepared_).seen(p_px, near_mm, far_mm);
}

DepthImage RayCast::picture() const {
  // Squares of pixels, so that rays share their ways.
  constexpr int square_px = 16;
  const glm::ivec2 size_px = prepared_->size_px;
  DepthImage image{size_px, {}};
  image.pixels.resize(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
  const glm::ivec2 squares = (size_px + (square_px - 1)) / square_px;
  tbb::parallel_for(0, squares.x * squares.y, [&](int square) {
    Caster caster(*prepared_);
    const glm::ivec2 first = glm::ivec2(square % squares.x, square / squares.x) * square_px;
    const glm::ivec2 last = glm::min(first + square_px, size_px);
    for (int y = first.y; y < last.y; ++y)
      for (int x = first.x; x < last.x; ++x)
        image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) +
                     static_cast<std::size_t>(x)] = caster.seen({x + 0.5, y + 0.5}, -infinity, infinity);
  });
  return image;
}

}  // namespace octotomy::voxel
