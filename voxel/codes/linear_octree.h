// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/codes/octal_code.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The linear octree, or leafcode (thesis 3.4.3, after Gargantini): the octal codes of the Full nodes of the
/// condensed octree, in preorder. The other nodes follow from the list: no code lies inside an Empty node,
/// and at least one inside a Partial node.
struct LinearOctree {
  Universe universe;
  std::vector<OctalCode> full;
};

/// The codes of an octree's Full nodes. Cost: one walk through the octree. Memory: 16 bytes per Full node.
LinearOctree linear_octree(const Octree& octree);
/// The object of a list of codes. Throws std::invalid_argument with the code that is too deep for the
/// universe, does not follow its predecessor in order, lies inside its predecessor, or is the last of eight
/// codes that form one Full node.
Octree octree_of(const LinearOctree& linear);

/// The codes as text, for example `17, 2, 34, 61, 62, 65`; `root` for a full universe.
std::string text(const LinearOctree& linear);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the codes. Memory: in proportion to the text.
LinearOctree parse_linear_octree(const Universe& universe, std::string_view text);

/// Whether the voxel lies in a Full node, by binary search. Preconditions: the voxel is in the universe, the
/// codes are in order.
bool contains(const LinearOctree& linear, const glm::ivec3& voxel);

}  // namespace octotomy::voxel
