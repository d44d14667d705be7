// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/logical_node.h"

namespace octotomy::voxel {

/// The explicit octree (thesis 3.4.3, after Woodwark): an entry for every possible node, so that a node's
/// octal code is the address of its entry. Level m has 8^m entries, and the entry with index `digits` is the
/// character of the node with these digits: E, F, P, or '.' if the node does not exist because an ancestor is
/// homogeneous.
struct ExplicitOctree {
  /// Above this depth 8^depth characters are more than a gigabyte.
  static constexpr int max_depth = 9;

  Universe universe;
  std::vector<std::string> levels;  ///< levels 0..n
};

/// The explicit octree of an object. Throws std::length_error for universes deeper than max_depth. Memory:
/// 8/7 times 8^depth bytes.
ExplicitOctree explicit_octree(const Octree& octree);
/// The object of an explicit octree. Throws std::invalid_argument with level and index of an entry that is
/// not E, F, P or '.', contradicts its parent, or is not condensed; also if the number of levels or the
/// length of a level does not match the universe's depth.
Octree octree_of(const ExplicitOctree& levels);

/// One line per level: `0 P`, `1 EPFPEEPE`, and so on.
std::string text(const ExplicitOctree& levels);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the entries. Memory: as large as the text.
ExplicitOctree parse_explicit_octree(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
