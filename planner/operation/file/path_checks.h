// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace octotomy::planner {

/// Whether a path has the extension of a mesh file.
bool is_mesh(const std::filesystem::path& path);

/// Whether a path has the extension .octree.
bool is_octree(const std::filesystem::path& path);

/// The kind of output that a verb writes to a path.
enum class OutputKind { File, Folder };

/// Checks an output before the work, so that no work is lost. Throws std::runtime_error or voxel::Error if no
/// file or folder can be made at `out`, if it would replace something of another kind, or if the data file
/// beside it belongs to another header (voxel::need_own_data_file()). To test the folder, makes a hidden
/// folder beside `out` for a moment.
void need_folder_of(const std::filesystem::path& out, OutputKind kind);
/// Calls need_folder_of() for an output that is a file.
void need_folder_of(const std::filesystem::path& out);

/// Throws std::runtime_error if the path ends in none of the extensions, with the message "OUT: WHAT written
/// as .a or .b".
void need_extension(const std::filesystem::path& out, const std::vector<std::string>& extensions,
                    const std::string& what);

/// Throws std::runtime_error if meshes cannot be written with the path's extension.
void need_mesh_extension(const std::filesystem::path& out);

/// Throws std::runtime_error if the path does not end in .octree.
void need_octree_extension(const std::filesystem::path& out);

/// Throws std::runtime_error if pictures cannot be written with the path's extension.
void need_picture_extension(const std::filesystem::path& out);

}  // namespace octotomy::planner
