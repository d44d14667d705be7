// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The symmetric bi-tree (thesis 3.3, after Srihari): each inhomogeneous node is halved along one axis,
/// chosen so that the whole tree has the fewest nodes. Nodes in preorder: E, F, or the axis x, y or z of the
/// cut, followed by the nodes of the low half and those of the high half.
struct BiTree {
  /// Above this depth the search needs more than a gigabyte of memory.
  static constexpr int max_depth = 7;

  Universe universe;
  std::string nodes;
};

/// The bi-tree with the fewest nodes; of axes with equal counts, the first is halved. Throws
/// std::length_error for universes deeper than max_depth. Cost: one search in each of the (2^(depth + 1) -
/// 1)^3 boxes that halving can reach. Memory: 6 bytes for each box.
BiTree bi_tree(const Octree& octree);
/// The object of a bi-tree. Throws std::invalid_argument with the position of a node that is missing or
/// surplus, that halves an edge of one voxel, or whose halves are both Full or both Empty.
Octree octree_of(const BiTree& tree);

/// The nodes as one word, for example `zxEFE`.
std::string text(const BiTree& tree);
/// The inverse of text(); octree_of() checks the nodes.
BiTree parse_bi_tree(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
