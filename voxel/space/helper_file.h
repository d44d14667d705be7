// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace octotomy::voxel {

/// Makes helper_file() look in `folder` alone; an empty path undoes it. Not for several threads at once.
void set_helper_folder(const std::filesystem::path& folder);

/// The path of a program or module that the library starts or loads on demand. Looks in the folder that
/// set_helper_folder() names; else in the one of the environment variable OCTOTOMY_HELPERS; else in the
/// running program's folder, in the place of an installation that this program belongs to, and in the place
/// that the library was configured for. Throws Error (Resource) that names the places it looked in, or
/// where somebody other than this user, root and the running program's owner could have put that file there
/// or may change it.
std::filesystem::path helper_file(const std::string& name);

}  // namespace octotomy::voxel
