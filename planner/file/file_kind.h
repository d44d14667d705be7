// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>

namespace octotomy::planner {

/// Whether a path is a surface's by its extension.
bool is_mesh(const std::filesystem::path& path);

/// Whether a path is an octree's by its extension.
bool is_octree(const std::filesystem::path& path);

/// Throws std::runtime_error or voxel::Error where a file cannot be made at `out`: before the work, so that
/// none is lost. Tries it with a hidden folder beside the file.
void need_folder_of(const std::filesystem::path& out);

/// Throws std::runtime_error where no mesh is written with the path's extension.
void need_mesh_extension(const std::filesystem::path& out);

/// Throws std::runtime_error where a path does not end in .octree.
void need_octree_extension(const std::filesystem::path& out);

}  // namespace octotomy::planner
