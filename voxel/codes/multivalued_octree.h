// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Several objects in one octree (thesis 3.2.1, 3.3): each voxel stores the number of its object, or 0 if it
/// is in none. A node is homogeneous if all its voxels have one number.
struct MultivaluedOctree {
  static constexpr std::uint8_t partial = 255;  ///< marks a node whose eight children follow

  Universe universe;
  std::vector<std::uint8_t> nodes;  ///< in preorder: an object's number, or `partial`
};

/// Objects have the numbers 1, 2, ... in the order given; a voxel of several objects belongs to the first of
/// them. Throws std::invalid_argument if there are no objects or more than 254, or if their universes differ.
/// Cost: a walk of all objects together.
MultivaluedOctree multivalued_octree(const std::vector<Octree>& objects);
/// The object that consists of the voxels with the given number. Throws std::invalid_argument that names a
/// node that is missing or surplus, a voxel that is Partial, or a Partial node whose eight children have the
/// same number.
Octree object_of(const MultivaluedOctree& tree, int number);

/// Numbers separated by spaces, and P(...) for Partial nodes: `P(0 0 1 2 0 0 P(1 1 0 0 0 0 0 0) 0)`.
std::string text(const MultivaluedOctree& tree);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character.
MultivaluedOctree parse_multivalued_octree(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
