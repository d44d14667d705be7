// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/space/lattice.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {

/// A set of voxels of a universe. Copies share their nodes, which never change, so copying is cheap and any
/// number of threads may read one.
class Octree {
 public:
  static Octree empty(const Universe& universe) { return Octree(universe, Block()); }
  static Octree full(const Universe& universe);
  /// `root` is a block of root_height(universe.depth). Precondition: it has no voxel outside the universe.
  Octree(const Universe& universe, Block root) : universe_(universe), root_(std::move(root)) {}

  const Universe& universe() const { return universe_; }
  BlockRef root() const { return root_.ref(); }
  /// The root block has 4^height voxels a side: at least the universe's side, at most twice that side or 16
  /// voxels.
  int root_height() const { return octotomy::voxel::root_height(universe_.depth); }

  bool is_empty() const { return root().is_empty(); }
  /// Number of voxels inside; constant time.
  std::uint64_t voxel_count() const;
  /// The block of height 2 with the given number, in units of its own side; Empty outside the universe.
  BlockRef leaf_block(const glm::ivec3& number) const;
  /// Voxels outside the universe are not contained.
  bool contains(const glm::ivec3& voxel) const;
  /// Whether universe and voxels are the same. Shared nodes are not compared.
  bool operator==(const Octree& other) const;

 private:
  Universe universe_;
  Block root_;
};

/// Numbers of nodes of one logical level as the thesis counts them: level 0 is the root, level n holds single
/// voxels; homogeneous nodes have no children.
struct LevelCount {
  int level = 0;
  std::uint64_t partial = 0;
  std::uint64_t full = 0;
  std::uint64_t empty = 0;
};
/// Levels 1..n of the condensed octree (thesis 3.3, 3.4).
std::vector<LevelCount> level_counts(const Octree& octree);

/// Bytes of the nodes reachable from the octree; a shared node counts once.
std::uint64_t bytes_memory(const Octree& octree);

}  // namespace octotomy::voxel
