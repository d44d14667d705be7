// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/browser/server/session.h"

// Folders may be named after patients, so windows that may only look receive file names in place of paths.
namespace octotomy::planner::serve {

/// The folders in which the open plan, its scans and the files of its steps lie, each with a slash at its end
/// and the longest first: as the plan states them, joined to the plan's folder, and without links. Of the
/// working folder alone if no plan is open.
std::vector<std::string> folders_of(const Session& session);

/// The text without `folders`; from other absolute paths only the file's name stays.
std::string without_folders(std::string text, const std::vector<std::string>& folders);
/// Shortens all texts of a value, and in any member "path" also a relative path.
Json without_folders(Json said, const std::vector<std::string>& folders);

}  // namespace octotomy::planner::serve
