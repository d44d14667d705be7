// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace octotomy::planner {

/// The versions of the libraries that the program uses, by their names. For shared libraries, the version
/// that is loaded; for others, that of the build.
nlohmann::ordered_json library_versions();

}  // namespace octotomy::planner
