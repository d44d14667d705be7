// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/logical_node.h"

namespace octotomy::voxel {

/// The explicit octree (thesis 3.4.3, after Woodwark): room for every node that could be, so that an octal
/// code is an address. Entry `digits` of level m, of 8^m entries, is the node's character: E, F, P, or '.'
/// where no such node exists because an ancestor is homogeneous.
struct ExplicitOctree {
  /// Above this depth 8^depth characters are more than a gigabyte.
  static constexpr int max_depth = 9;

  Universe universe;
  std::vector<std::string> levels;  ///< levels 0..n
};

/// Throws std::length_error for universes deeper than max_depth. Memory: 8^depth bytes and a seventh.
ExplicitOctree explicit_octree(const Octree& octree);
/// Throws std::invalid_argument naming the level and entry that is not E, F, P or '.', does not fit its
/// parent, or is not condensed; and where levels are not as many and as long as the universe's depth asks.
Octree octree_of(const ExplicitOctree& levels);

/// A line a level: `0 P`, `1 EPFPEEPE`, and so on.
std::string text(const ExplicitOctree& levels);
/// The inverse. Throws std::invalid_argument with the position of the character; statuses are checked by
/// octree_of(). Memory: the text's.
ExplicitOctree parse_explicit_octree(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
