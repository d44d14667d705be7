// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "voxel/tree/octree.h"
#include "voxel/tree/octree_node.h"
#include "voxel/view/camera.h"

// The walk of one ray through an octree, block by block. The walk descends to the block at the current voxel.
// It leaves an empty block through the first of the block's planes that the ray meets (Amanatides, Woo 1987,
// on blocks of any size), and descends again from the smallest block that contains both the old and the new
// voxel.
//
// Rays are walked in the *mirrored frame*: index space is shifted so that voxel i extends from i to i + 1,
// and every axis along which the ray's coordinate decreases is reversed, so that all coordinates increase
// along the ray. If a ray does not move along an axis, its time to a plane across that axis is infinite.
//
// This header is longer than others, because the receiver of the voxels is inlined into the innermost loop.

namespace octotomy::voxel {

/// The mirrored frame of a view's rays, in which all components of their direction are at least zero.
struct Mirror {
  /// For rays of `per_mm` voxels per millimetre of depth through a root block of `root_side` voxels a side.
  Mirror(const glm::dvec3& per_mm, int root_side) : side(root_side) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = per_mm[axis];
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

/// A ray's passage through a voxel of the object.
struct Passage {
  glm::ivec3 voxel{0};  ///< mirrored
  double enter_mm = -std::numeric_limits<double>::infinity();
  double leave_mm = std::numeric_limits<double>::infinity();
  int entered_through = 0;  ///< axis
};

/// The passage of a ray from `start` (mirrored) through a voxel. Precondition: the ray meets the voxel.
inline Passage passage_of(const Mirror& mirror, const glm::dvec3& start, const glm::ivec3& voxel) {
  Passage passage{voxel};
  for (int axis = 0; axis < 3; ++axis) {
    if (mirror.still[axis]) continue;
    const double enter = (voxel[axis] - start[axis]) * mirror.mm_per_voxel[axis];
    if (enter > passage.enter_mm) {
      passage.enter_mm = enter;
      passage.entered_through = axis;
    }
    passage.leave_mm = std::min(passage.leave_mm, enter + mirror.mm_per_voxel[axis]);
  }
  return passage;
}

/// Walks rays through one octree. Stores the path of nodes to the last voxel, because neighbouring rays share
/// most of this path.
class Walk {
 public:
  Walk(BlockRef root, int height, const Mirror& mirror) : mirror_(mirror), top_(height), lowest_(height) {
    nodes_[static_cast<std::size_t>(height)] = root.node();
    full_root_ = root.is_full();
  }

  /// Calls `accept` with the object's voxels that a ray passes between two depths, in order, until `accept`
  /// returns true.
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
        // In a Full block the ray walks voxel by voxel.
        if (accept(pass()) || !leave(1)) return;
      }
    }
  }

 private:
  enum class LeafWay { Accepted, Left, Behind };

  /// Walks the ray's voxels in the current leaf. Afterwards the current voxel is the first behind the leaf.
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

  /// Shortens the path to the nodes that contain both the current voxel and `other`.
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

  /// The edge of the largest aligned empty block found around the voxel. 0 if the voxel is in a Full block,
  /// or in a leaf whose word is stored in word_.
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
        // The child is empty. Its logical octant may be empty too.
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

  Passage pass() const { return passage_of(mirror_, start_, voxel_); }

  /// Moves into the voxel behind the aligned block of the given edge. Returns false if this voxel is outside
  /// the root block.
  bool leave(int edge) {
    const glm::ivec3 end = (voxel_ & ~(edge - 1)) + edge;
    const glm::dvec3 time = (glm::dvec3(end) - start_) * mirror_.mm_per_voxel + mirror_.exit_offset;
    const double leave_mm = std::min(time.x, std::min(time.y, time.z));
    const glm::dvec3 p = start_ + leave_mm * mirror_.speed_per_mm;
    // The new position is clamped, because rounding must not move the ray backwards or out of the block's
    // other sides. There are no branches, because the side through which a ray leaves is unpredictable.
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
  int lowest_;  ///< height of the lowest node on the path that contains the voxel; 1: the leaf in word_
  bool full_root_ = false;
  glm::ivec3 voxel_{0};
  double at_mm_ = 0.0;
  std::uint64_t word_ = 0;
  std::array<const Node*, Universe::max_depth / 2 + 1> nodes_{};
};

}  // namespace octotomy::voxel
