// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The same plan for another folder: relative paths of scans, and of files that steps read, are rewritten to
/// name the same files from there. Paths of files that the plan writes are unchanged, because they are
/// relative to the result's folder; so are absolute paths. If the folder is the same, the text is unchanged
/// to the byte. Throws std::runtime_error if the two folders have no common root.
Plan rebased(const Plan& plan, const std::filesystem::path& folder);

/// The plan with other files in place of those that its steps read.
Plan with_files(const Plan& plan, const std::map<std::filesystem::path, std::filesystem::path>& places);

}  // namespace octotomy::planner
