// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <unordered_set>
#include <vector>

#include "voxel/logical_node.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

/// Visits to nodes of one kind: of a level by status, and to the quadtree of the picture.
struct VisitTally {
  std::vector<LevelCount> octree;  ///< levels 1..n
  std::uint64_t quadtree = 0;      ///< levels 0..n
};

/// What drawing cost, in the terms of the thesis's appendix A (A.3.1): a visit is *direct* where an octree
/// node is tested against its part of the picture, *indirect* where it is only passed on the way to a
/// neighbour.
struct Visits {
  std::vector<LevelCount> existing;  ///< nodes there are, levels 1..n
  VisitTally direct;
  VisitTally all;                   ///< direct and indirect
  std::uint64_t visited_count = 0;  ///< nodes of levels 1..n with a visit of any kind
  std::uint64_t pixel_count = 0;    ///< of the quadtree for views along axes, of the picture otherwise

  /// Visits to the quadtree, spread over its pixels (A.4.1).
  double per_pixel(const VisitTally& tally) const {
    return static_cast<double>(tally.quadtree) / static_cast<double>(pixel_count);
  }
  /// Share of the existing nodes without a visit; none where there is no node.
  std::optional<double> unvisited_fraction() const;
  /// Adds the visits to another object in the same picture.
  void add(const Visits& other);
};

/// The counter of a walk that counts nothing: its calls compile to nothing.
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

  /// A visit to a node, named by a corner in voxels that no other node of its level has. The root's are not
  /// kept.
  void direct(int level, Status status, const glm::ivec3& corner);
  void indirect(int level, Status status, const glm::ivec3& corner);
  void quadtree(std::uint64_t direct, std::uint64_t indirect) {
    visits_.direct.quadtree += direct;
    visits_.all.quadtree += direct + indirect;
  }
  Visits visits() const;

 private:
  void note(int level, const glm::ivec3& corner);

  Visits visits_;
  std::unordered_set<std::uint64_t> visited_;
};

}  // namespace octotomy::voxel
