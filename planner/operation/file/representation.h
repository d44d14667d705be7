// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The names of the representations of chapter 3 in the options --as and --from of `octotomy octree`:
/// treecode, linear, explicit, masked, bitree, multivalued, runs, segments, marginal, faces, array (text),
/// packed, bits (bytes).
std::vector<std::string> representation_names();

/// The bytes of a file with the octrees in the named representation. A text ends with a line end. A
/// multivalued code contains several objects of one universe, numbered from 1 in their order; a voxel in
/// several objects belongs to the first. Throws std::invalid_argument for an unknown name, stating the
/// nearest known one, and for several objects in any other code; std::length_error if the universe is too
/// deep for a representation that holds every voxel, with the largest depth.
std::string represented(const std::vector<voxel::Octree>& objects, std::string_view name);

/// Reads the octree from such bytes. The caller states the universe, because the representation does not.
/// From a multivalued code, returns the object with this number. Throws std::invalid_argument with the
/// position of the fault.
voxel::Octree octree_of_representation(const voxel::Universe& universe, std::string_view name,
                                       std::string_view content, int number = 1);

}  // namespace octotomy::planner
