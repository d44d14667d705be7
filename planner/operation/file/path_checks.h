// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace octotomy::planner {

/// Whether a path has the extension of a surface's file.
bool is_mesh(const std::filesystem::path& path);

/// Whether a path has the extension of an octree's file.
bool is_octree(const std::filesystem::path& path);

/// What a verb writes to a path.
enum class OutputKind { File, Folder };

/// Throws std::runtime_error or voxel::Error if no file or folder can be made at `out`, if it would replace
/// something of another kind, or if the data file beside it belongs to another header
/// (voxel::need_own_data_file()). Called before the work, so that no work is lost. Tests this with a hidden
/// folder beside the path.
void need_folder_of(const std::filesystem::path& out, OutputKind kind);
/// Calls need_folder_of() for an output that is a file.
void need_folder_of(const std::filesystem::path& out);

/// Throws std::runtime_error, "OUT: WHAT written as .a or .b", where the path ends in none of the extensions.
void need_extension(const std::filesystem::path& out, const std::vector<std::string>& extensions,
                    const std::string& what);

/// Throws std::runtime_error where no mesh is written with the path's extension.
void need_mesh_extension(const std::filesystem::path& out);

/// Throws std::runtime_error where a path does not end in .octree.
void need_octree_extension(const std::filesystem::path& out);

/// Throws std::runtime_error where no picture is written with the path's extension.
void need_picture_extension(const std::filesystem::path& out);

}  // namespace octotomy::planner
