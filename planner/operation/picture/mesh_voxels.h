// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/operation/table/operation.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// What a mesh in a file encloses, closed or not, as voxels to be drawn: of the universe, or of one around
/// the mesh with voxels of a length, by default a 400th of its extent. Throws std::runtime_error, naming the
/// path, for a mesh that encloses no voxel.
voxel::Octree voxels_of_mesh(const std::filesystem::path& path,
                             const std::optional<voxel::Universe>& universe,
                             const std::optional<double>& voxel_mm, const FileBench& bench);

}  // namespace octotomy::planner
