// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The representations of chapter 3 by the names that `octotomy octree --as` and `--from` know: treecode, linear,
/// explicit, masked, bitree, multivalued, runs, segments, marginal, faces, array (text), packed, bits (bytes).
std::vector<std::string> representation_names();

/// The octree as that representation's file: a line end closes a text. Multivalued codes take several objects of one
/// universe, numbered from 1 in their order; a voxel of several belongs to the first. Throws std::invalid_argument
/// for an unknown name, with the nearest known one, and for several objects of another code; std::length_error if the
/// universe is too deep for a representation that holds every voxel, with the largest depth.
std::string represented(const std::vector<voxel::Octree>& objects, std::string_view name);

/// The inverse. The representation does not state the universe, so the caller passes it. From a multivalued
/// code, returns the object of this number. Throws std::invalid_argument with the position of the fault.
voxel::Octree octree_of_representation(const voxel::Universe& universe, std::string_view name,
                                       std::string_view content, int number = 1);

}  // namespace octotomy::planner
