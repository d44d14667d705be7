// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The octree as treecode (thesis 3.4.3, after Oliver): nodes in preorder, E for Empty, F for Full, P for
/// Partial followed by its eight children, x + 2y + 4z, in parentheses:
/// `P(EP(EEEEEEEF)FP(EEEEFEEE)EEP(EFFEEFEE)E)`. The text does not contain the universe's depth. Its length is
/// one character for each node, and two more for each Partial node.
std::string treecode(const Octree& octree);

/// The octree of a treecode. Spaces and line ends are allowed between nodes. Throws std::invalid_argument
/// with the position of the character if the text is no treecode, is deeper than the universe, or is not
/// condensed (eight children that are all Full or all Empty must be one node). Memory: that of the octree.
Octree octree_of_treecode(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
