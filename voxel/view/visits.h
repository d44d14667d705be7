// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <unordered_set>
#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/logical_node.h"
#include "voxel/tree/octree.h"
#include "voxel/tree/window_bits.h"
#include "voxel/view/camera.h"

namespace octotomy::voxel {

/// The numbers of visits of one kind, direct or indirect: to the octree's nodes by level and status, and to
/// the picture's quadtree.
struct VisitTally {
  std::vector<LevelCount> octree;  ///< levels 1..n
  std::uint64_t quadtree = 0;      ///< levels 0..n
};

/// The cost of drawing in the terms of the thesis's appendix A (A.3.1). A *direct* visit tests an octree node
/// against its part of the picture; an *indirect* visit only passes through the node on the way to a
/// neighbour.
struct Visits {
  std::vector<LevelCount> existing;  ///< number of nodes on levels 1..n
  VisitTally direct;
  VisitTally all;  ///< direct and indirect
  /// Number of nodes on levels 1..n with at least one visit of either kind.
  std::uint64_t visited_count = 0;
  /// Number of nodes on levels 1..n with at least one direct visit.
  std::uint64_t directly_visited_count = 0;
  /// Number of pixels, of the quadtree for views along axes, of the picture otherwise.
  std::uint64_t pixel_count = 0;

  /// The number of visits to the quadtree per pixel (A.4.1).
  double per_pixel(const VisitTally& tally) const {
    return static_cast<double>(tally.quadtree) / static_cast<double>(pixel_count);
  }
  /// The share of nodes without a visit; none if there is no node.
  std::optional<double> unvisited_fraction() const;
  /// The share of nodes without a direct visit; none if there is no node.
  std::optional<double> directly_unvisited_fraction() const;
  /// Adds the visits to another object in the same picture.
  void add(const Visits& other);
};

/// The counter for a walk that does not count; its calls compile to nothing.
struct NoVisits {
  void direct(int, Status, const glm::ivec3&) {}
  void indirect(int, Status, const glm::ivec3&) {}
  void quadtree(std::uint64_t, std::uint64_t) {}
};

/// The counter of a walk through one octree.
class VisitCounter {
 public:
  /// Room for levels 1..existing.size().
  VisitCounter(std::vector<LevelCount> existing, std::uint64_t pixel_count);

  /// Counts a visit to a node. The node is identified by a corner, in voxels, that no other node of its level
  /// has. Ignores visits to the root.
  void direct(int level, Status status, const glm::ivec3& corner);
  void indirect(int level, Status status, const glm::ivec3& corner);
  void quadtree(std::uint64_t direct, std::uint64_t indirect) {
    visits_.direct.quadtree += direct;
    visits_.all.quadtree += direct + indirect;
  }
  Visits visits() const;

 private:
  Visits visits_;
  std::unordered_set<std::uint64_t> visited_, directly_visited_;
};

/// Visits of node tracing through a grey octree whose Partial nodes store nothing (thesis A.4.2): a node is
/// opened unless all its samples are equal. The difference from the visits that render() counts with
/// DrawnObject::counted_in_grey is the saving by the minimum and maximum at each node. Precondition: the axes
/// belong to the octree's universe, and the window excludes the background.
Visits visits_without_ranges(const GreyOctree& grey, Window16 window, const AxisView& axes);

/// Visits of node tracing through a grey octree if each depth is interpolated (thesis 5.2.2.2): the visits
/// that render() counts with DrawnObject::counted_in_grey, plus the visits for reading samples of the
/// surface's voxels and of the voxels in front of these. Nodes of unequal samples are opened for these reads.
/// Preconditions are those of visits_without_ranges().
Visits visits_with_depths(const GreyOctree& grey, Window16 window, const AxisView& axes);

}  // namespace octotomy::voxel
