// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The octree as treecode in bytes, as in `.octree` files. The first byte is the root: 0 Empty, 1 Full, 2
/// Partial. Then every Partial node, in preorder, has two bytes for its eight children: bit x + 2y + 4z of
/// the first byte is set if the child is Full, the same bit of the second byte if it is Partial, and neither
/// if it is Empty. If the children are voxels, which cannot be Partial, the second byte is left out. Cost:
/// one walk through the octree. Size: two bytes for each Partial node, one if its children are voxels.
std::vector<std::uint8_t> packed_treecode(const Octree& octree);

/// The octree of a packed treecode. Throws std::invalid_argument with the number of the wrong byte if the
/// bytes are no treecode, are not condensed, end early or continue after the last node. Memory: that of the
/// octree.
Octree octree_of_packed_treecode(const Universe& universe, std::span<const std::uint8_t> code);

}  // namespace octotomy::voxel
