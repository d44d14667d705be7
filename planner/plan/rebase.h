// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>

#include "planner/plan/plan.h"

namespace octotomy::planner {

/// The same plan as it reads in another folder: relative paths of scans, and of the files that steps read,
/// name the same files from there. Paths of files that the plan writes stay, as they lie in the result's
/// folder; so do absolute ones. A plan of the same folder keeps its text to the byte. Throws
/// std::runtime_error where the two folders share no root.
Plan rebased(const Plan& plan, const std::filesystem::path& folder);

/// The plan with other files in place of those that its steps read.
Plan with_files(const Plan& plan, const std::map<std::filesystem::path, std::filesystem::path>& places);

}  // namespace octotomy::planner
