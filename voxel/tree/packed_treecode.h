// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The octree as treecode in bytes, as `.octree` files hold it. The first byte is the root: 0 Empty, 1 Full,
/// 2 Partial. Then every Partial node, in preorder, gives its eight children: a byte of which bit x + 2y + 4z
/// says that the child is Full, and a byte that says likewise which are Partial; the others are Empty.
/// Children that are voxels cannot be Partial, their second byte is left out.
/// Cost: one walk; two bytes a Partial node, one if its children are voxels.
std::vector<std::uint8_t> packed_treecode(const Octree& octree);

/// The inverse. Throws std::invalid_argument with the number of the byte if the code is none, is not
/// condensed, ends early or goes on. Memory: the octree's.
Octree octree_of_packed_treecode(const Universe& universe, std::span<const std::uint8_t> code);

}  // namespace octotomy::voxel
