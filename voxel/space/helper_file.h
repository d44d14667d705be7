// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace octotomy::voxel {

/// Makes helper_file() search only `folder`; an empty path restores the default. Not thread-safe.
void set_helper_folder(const std::filesystem::path& folder);

/// The path of a program or module that the library starts or loads on demand. Searches the folder set by
/// set_helper_folder(); otherwise the folder in the environment variable OCTOTOMY_HELPERS; otherwise the
/// running program's folder, its place relative to that folder in an installation, and the place for which
/// the library was configured. Throws Error (Resource) with the places searched if it is found in none. Also
/// throws if the file or its folder is writable by everyone, or belongs to a user other than the current one,
/// root and the running program's owner.
std::filesystem::path helper_file(const std::string& name);

}  // namespace octotomy::voxel
