// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/logical_node.h"

namespace octotomy::voxel {

/// The explicit octree (thesis 3.4.3, after Woodwark): an entry for every possible node, so that an octal
/// code is an address. Entry `digits` of the 8^m entries of level m is the node's character: E, F, P, or '.'
/// if the node does not exist because an ancestor is homogeneous.
struct ExplicitOctree {
  /// Above this depth 8^depth characters are more than a gigabyte.
  static constexpr int max_depth = 9;

  Universe universe;
  std::vector<std::string> levels;  ///< levels 0..n
};

/// Throws std::length_error for universes deeper than max_depth. Memory: 8^depth bytes and a seventh.
ExplicitOctree explicit_octree(const Octree& octree);
/// Throws std::invalid_argument that names the level and entry which is not E, F, P or '.', contradicts its
/// parent, or is not condensed; also if the number or length of levels is not that of the universe's depth.
Octree octree_of(const ExplicitOctree& levels);

/// One line per level: `0 P`, `1 EPFPEEPE`, and so on.
std::string text(const ExplicitOctree& levels);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the entries. Memory: the text's.
ExplicitOctree parse_explicit_octree(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
