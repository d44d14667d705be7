// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/octal_code.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

/// The linear octree, or leafcode (thesis 3.4.3, after Gargantini): the octal codes of the Full nodes of the
/// condensed octree, in preorder. Empty and Partial nodes follow from what is missing: an Empty node is a
/// sublist of no codes, a Partial one of two or more.
struct LinearOctree {
  Universe universe;
  std::vector<OctalCode> full;
};

/// Cost: one walk; 16 bytes a Full node.
LinearOctree linear_octree(const Octree& octree);
/// Throws std::invalid_argument naming the code that is too deep for the universe, not after its predecessor,
/// inside it, or the last of eight that are one Full node.
Octree octree_of(const LinearOctree& linear);

/// `17, 2, 34, 61, 62, 65`; a full universe is `root`.
std::string text(const LinearOctree& linear);
/// The inverse. Throws std::invalid_argument with the position of the character; the codes are checked by
/// octree_of(). Memory: in proportion to the text.
LinearOctree parse_linear_octree(const Universe& universe, std::string_view text);

/// Whether the voxel lies in a Full node, by binary search among the codes. Precondition: inside the
/// universe, the codes in order.
bool contains(const LinearOctree& linear, const glm::ivec3& voxel);

}  // namespace octotomy::voxel
