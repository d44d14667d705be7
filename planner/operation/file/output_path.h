// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// Refuses a path that is not within the result's folder, that an earlier step writes, or that ends in none
/// of `extensions`.
void check_output_path(const std::filesystem::path& path, const std::vector<std::string>& extensions,
                       const FieldLocation& place);

/// The file that a path names below a result's folder. Makes the folders on the way, but never the result's
/// own folder: if that was removed, it must not reappear.
std::filesystem::path output_file(const std::filesystem::path& folder, const std::filesystem::path& path);

/// The path without "." and "..", as it is written and reported.
std::filesystem::path output_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
