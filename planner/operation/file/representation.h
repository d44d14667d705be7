// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The representations of chapter 3 by the names that `octotomy octree --as` and `--from` know: treecode,
/// linear, explicit, runs, segments, marginal, faces, array (text), packed, bits (bytes).
std::vector<std::string> representation_names();

/// The octree as that representation's file: a line end closes a text. Throws std::invalid_argument for a
/// name that is none, with the nearest; std::length_error where the universe is too deep for a representation
/// that holds every voxel, saying which depth is not.
std::string represented(const voxel::Octree& octree, std::string_view name);

/// The inverse, in a universe that the representation does not tell. Throws std::invalid_argument with the
/// position of what is wrong.
voxel::Octree octree_of_representation(const voxel::Universe& universe, std::string_view name,
                                       std::string_view content);

}  // namespace octotomy::planner
