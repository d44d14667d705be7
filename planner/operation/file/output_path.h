// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// Refuses a path that lies outside of the result's folder, that an earlier step writes, or that ends in none
/// of `extensions`.
void check_output_path(const std::filesystem::path& path, const std::vector<std::string>& extensions,
                       const FieldLocation& place);

/// The file at `path` within a result's folder. Makes the folders between them, but not the result's folder:
/// if the user removed it, it must not reappear.
std::filesystem::path output_file(const std::filesystem::path& folder, const std::filesystem::path& path);

/// The path without "." and "..": the form in which it is written and reported.
std::filesystem::path output_path(const std::filesystem::path& path);

}  // namespace octotomy::planner
