// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "planner/operation/table/operation.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// The inside of a mesh in a file, closed or not, as voxels for drawing. They are in the stated universe, or
/// in a universe around the mesh with voxels of the stated length, by default 1/400 of the mesh's extent.
/// Throws std::runtime_error that names the path if the mesh encloses no voxel.
voxel::Octree voxels_of_mesh(const std::filesystem::path& path,
                             const std::optional<voxel::Universe>& universe,
                             const std::optional<double>& voxel_mm, const FileBench& bench);

}  // namespace octotomy::planner
