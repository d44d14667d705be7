// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/space/lattice.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {

/// A set of voxels of a universe. Nodes never change and copies share them, so copying is cheap and any
/// number of threads may read an octree.
class Octree {
 public:
  static Octree empty(const Universe& universe) { return Octree(universe, Block()); }
  static Octree full(const Universe& universe);
  /// `root` is a block of height root_height(universe.depth). Precondition: the block has no voxel outside
  /// the universe.
  Octree(const Universe& universe, Block root) : universe_(universe), root_(std::move(root)) {}

  const Universe& universe() const { return universe_; }
  BlockRef root() const { return root_.ref(); }
  /// The root block has 4^height voxels a side: at least the universe's side, at most twice that side or 16
  /// voxels.
  int root_height() const { return octotomy::voxel::root_height(universe_.depth); }

  bool is_empty() const { return root().is_empty(); }
  /// The number of voxels in the set. Takes constant time.
  std::uint64_t voxel_count() const;
  /// The block of height 2 with the given number, in units of its own side; Empty outside the universe.
  BlockRef leaf_block(const glm::ivec3& number) const;
  /// Whether a voxel is in the set; false for voxels outside the universe.
  bool contains(const glm::ivec3& voxel) const;
  /// Whether universe and voxels are equal. Nodes that both octrees share are not compared.
  bool operator==(const Octree& other) const;

 private:
  Universe universe_;
  Block root_;
};

/// The numbers of nodes of one logical level, by status, as the thesis counts them: level 0 is the root,
/// level n holds single voxels; homogeneous nodes have no children.
struct LevelCount {
  int level = 0;
  std::uint64_t partial = 0;
  std::uint64_t full = 0;
  std::uint64_t empty = 0;
};
/// Levels 1..n of the condensed octree (thesis 3.3, 3.4).
std::vector<LevelCount> level_counts(const Octree& octree);

/// The memory of the octree's nodes in bytes. A node that occurs several times is counted once.
std::uint64_t bytes_memory(const Octree& octree);

}  // namespace octotomy::voxel
