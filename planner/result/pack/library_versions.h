// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// Versions of the libraries that the program computes, reads and writes with, by their names. Shared libraries
/// state the version that is loaded, the others that of the build.
nlohmann::ordered_json library_versions();

}  // namespace octotomy::planner
