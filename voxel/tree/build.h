// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The voxels whose sample lies in low..high, both included. Scene voxel i is universe voxel i, so both
/// lattices must have the same first voxel, axes and spacing. Voxels beyond the scene are empty. Throws
/// std::invalid_argument if the lattices differ or the scene does not fit into the universe. Parallel; same
/// bits on any thread count. Cost: one pass over the samples.
Octree octree_of_window(const Universe& universe, const Scene& scene, double low, double high);

/// The octree whose 16 x 16 x 16 blocks `make` returns. `make` is called once for every such block of the
/// universe, from several threads, with the block's number along each axis. It returns the block as made by
/// make_leaf_block(). Voxels beyond the universe must be empty.
Octree octree_of_blocks(const Universe& universe, const std::function<Block(const glm::ivec3& block)>& make);

/// A block of height 2 as rows of 16 voxels: the row at (y, z) is number y + 16 z, and bit x is voxel x.
using BlockRows = std::array<std::uint16_t, 256>;
Block leaf_block_of_rows(const BlockRows& rows);

/// The object that consists of those voxels of the box low..high, both included, that lie in the universe.
Octree octree_of_box(const Universe& universe, const glm::ivec3& low, const glm::ivec3& high);

}  // namespace octotomy::voxel
