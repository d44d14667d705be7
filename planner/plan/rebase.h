// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The same plan for another folder: relative paths of scans and of files that steps read name the same files
/// from there. Absolute paths stay, and so do paths of files that the plan writes, which are relative to the
/// result's folder. If the folder is the same, the text is the same, byte for byte. Throws std::runtime_error
/// if the folders have no common root.
Plan rebased(const Plan& plan, const std::filesystem::path& folder);

/// The plan in which steps read other files: `places` has the new path for each path of a file.
Plan with_files(const Plan& plan, const std::map<std::filesystem::path, std::filesystem::path>& places);

}  // namespace octotomy::planner
