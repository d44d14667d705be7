// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "voxel/lattice.h"
#include "voxel/scene.h"

namespace octotomy::voxel {

/// A min-max octree of int16 samples over dense leaves (thesis 3.3.2, hybrid tree of A.6): the window that
/// makes an object of it is chosen when it is looked at, not when it is built. Immutable; copies share.
class GreyOctree {
 public:
  /// Smallest and largest sample of a block.
  struct MinMax {
    std::int16_t low = 0;
    std::int16_t high = 0;
  };

  const Universe& universe() const { return universe_; }
  /// Blocks as octree_node.h defines them; blocks of one height form a dense grid, x fastest.
  int root_height() const;
  const MinMax& block(int height, const glm::ivec3& block) const;
  /// The 64 samples of the leaf block, in bit order. Where the leaf is homogeneous this is still valid.
  const std::int16_t* leaf(const glm::ivec3& block) const;
  /// The sample of a voxel; outside the universe, the background.
  std::int16_t sample(const glm::ivec3& voxel) const;
  std::int16_t background() const { return background_; }
  std::uint64_t bytes_memory() const;

 private:
  friend GreyOctree grey_octree_of(const Universe&, const Scene&, std::int16_t);
  struct Storage;
  Universe universe_;
  std::int16_t background_ = 0;
  std::shared_ptr<const Storage> storage_;
};

/// Samples the scene at the universe's voxel centres: exactly where the lattices coincide, otherwise by
/// trilinear interpolation rounded to the nearest integer. Voxels whose centre lies outside the scene's
/// bounds become `background`. Throws std::invalid_argument where float samples leave the int16 range.
/// Parallel; same bits on any thread count.
GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background = -1024);

}  // namespace octotomy::voxel
